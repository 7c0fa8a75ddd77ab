//! A drive in MDF 4 with decoded signals gives the cells of the signal table with the same numbers.

use super::own_signals::{Fix, Sent, VEHICLE, drive, estimate, write_table};
use estimator_core::Instant;
use test_kit::command::folder;
use test_kit::mdf::MdfBlocks;
use test_kit::mdf_signals::{MdfChannel, MdfGroup, MdfLayout, mdf_signals};

const SIGNALS: &str = r#"
[signals.traction_force_n]
signal = "WheelForce"
[signals.wheel_speed_mps]
message = "CAN 1"
signal = "VehicleSpeed"
invalid = [65535]
[signals.altitude_m]
signal = "Height\\GPS:1"
scale = 0.125
offset = -500
[signals.latitude_deg]
signal = "Lat"
"#;

fn group(
    name: &'static str,
    channels: Vec<MdfChannel>,
    records: impl Iterator<Item = (f64, Vec<u8>)>,
) -> MdfGroup {
    let with_time = |(time, bytes): (f64, Vec<u8>)| {
        let time_bytes = time.to_le_bytes();
        (time, [&time_bytes[..], &bytes].concat())
    };
    MdfGroup {
        name,
        source: "",
        channels: [vec![MdfChannel::time()], channels].concat(),
        invalidation_bytes: 0,
        records: records.map(with_time).collect(),
    }
}

/// Returns the drive in two groups: every 100 ms, and every second.
fn groups(drive: &[(Instant, Sent)]) -> [MdfGroup; 2] {
    let seconds = |time: &Instant| time.micros() as f64 / 1e6;
    let fast = drive.iter().map(|(time, sent)| {
        let force = sent.force.to_be_bytes();
        let speed = sent.speed.to_le_bytes();
        let braking = [u8::from(sent.braking)];
        (seconds(time), [&force[..], &speed, &braking].concat())
    });
    let slow = drive.iter().filter_map(|(time, sent)| {
        let Fix {
            height,
            latitude,
            longitude,
        } = sent.fix.as_ref()?;
        let place = [latitude.to_le_bytes(), longitude.to_le_bytes()].concat();
        let bytes = [&height.to_le_bytes()[..], &place, &[9]].concat();
        Some((seconds(time), bytes))
    });
    let number = |name, data_type, byte, bits, unit, factor| {
        MdfChannel::of_type(name, data_type, byte, bits)
            .with_unit(unit)
            .converted(1, &[0.0, factor])
    };
    [
        group(
            "CAN 1",
            vec![
                number("WheelForce", 3, 8, 16, "N", 0.5),
                number("VehicleSpeed", 0, 10, 16, "m/s", 1.0 / 128.0),
                number("brake", 0, 12, 8, "", 1.0),
            ],
            fast,
        ),
        group(
            "GNSS",
            vec![
                MdfChannel::of_type("Height\\GPS:1", 0, 8, 32).with_unit("counts"),
                number("Lat\\GPS:1", 2, 12, 32, "deg", 1e-7),
                number("longitude_deg", 2, 16, 32, "°", 1e-7),
                number("satellites", 0, 20, 8, "", 1.0),
            ],
            slow,
        ),
    ]
}

#[test]
fn channels_give_the_cells_of_the_signal_table() {
    let folder = folder();
    let write = |name: &str, bytes: &[u8]| std::fs::write(folder.path().join(name), bytes).unwrap();
    write("car.toml", VEHICLE.as_bytes());
    write("signals.toml", SIGNALS.as_bytes());
    let drive = drive();
    write_table(&folder.path().join("table.csv"), &drive);
    let of_table = estimate(folder.path(), "table.csv", "table.run.csv", &[]);
    assert!(of_table.lines().count() > 4_000, "12 km");
    for (blocks, layout) in [
        (MdfBlocks::Plain, MdfLayout::Sorted),
        (MdfBlocks::Transposed, MdfLayout::Unsorted),
        (MdfBlocks::Deflated, MdfLayout::Columns),
    ] {
        write("car.mf4", &mdf_signals(&groups(&drive), blocks, layout));
        let options = ["--signals", "signals.toml"];
        let of_channels = estimate(folder.path(), "car.mf4", "mdf.run.csv", &options);
        assert!(of_table == of_channels, "byte-identical: {layout:?}");
    }
}
