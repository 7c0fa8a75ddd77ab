//! A car's own bus: 11-bit identifiers and Motorola order, mapped by a SIGNALS.toml, give the cells of
//! the signal table with the same numbers; beside built-in messages, own signals go first.

use embedded_can::{Frame, StandardId};
use estimator_core::{Instant, Signal};
use host_sim::source::can_frame::{CanFrame, TimedFrame};
use host_sim::source::candump_writer::write_frame;
use host_sim::source::signal_table;
use std::path::Path;
use test_kit::command::{folder, program};

pub(super) const VEHICLE: &str = "[vehicle]\nname = \"car\"\nmass_kg = 1500.0\ndrag_area_m2 = 0.7\n\
    rolling_resistance = 0.01\nwheel_radius_m = 0.31\nwheel_inertia_kgm2 = 4.0\n\
    [traction]\nsource = \"force\"\n";

const DBC: &str = r#"VERSION ""
NS_ :
BS_:
BU_: Car
BO_ 257 Powertrain: 8 Car
 SG_ WheelForce : 7|16@0- (0.5,0) [-16384|16383.5] "N" Vector__XXX
 SG_ Gear : 19|4@0+ (1,0) [0|15] "" Vector__XXX
BO_ 300 Gps1: 8 Car
 SG_ Page M : 7|8@0+ (1,0) [0|255] "" Vector__XXX
 SG_ Sats m1 : 15|8@0+ (1,0) [0|255] "" Vector__XXX
 SG_ Height m1 : 23|24@0+ (0.125,-500) [-500|5000] "m" Vector__XXX
 SG_ Lat m2 : 15|32@0- (1E-07,0) [-90|90] "deg" Vector__XXX
 SG_ Lon m3 : 15|32@0- (1E-07,0) [-180|180] "deg" Vector__XXX
BO_ 513 Wheels: 8 Car
 SG_ Braking : 0|1@0+ (1,0) [0|1] "" Vector__XXX
 SG_ VehicleSpeed : 10|15@0+ (0.0078125,0) [0|255] "m/s" Vector__XXX
"#;

const SIGNALS: &str = r#"
[signals.traction_force_n]
message = "Powertrain"
signal = "WheelForce"
[signals.satellites]
message = "Gps1"
signal = "Sats"
[signals.altitude_m]
message = 300
signal = "Height"
[signals.latitude_deg]
message = "0x12C"
signal = "Lat"
[signals.longitude_deg]
message = "Gps1"
signal = "Lon"
[signals.brake]
message = "Wheels"
signal = "Braking"
[signals.wheel_speed_mps]
message = "Wheels"
signal = "VehicleSpeed"
invalid = [32767]
"#;

/// What the car sends at a time: raw numbers.
pub(super) struct Sent {
    pub force: i16,
    pub braking: bool,
    pub speed: u16,
    pub fix: Option<Fix>,
}

pub(super) struct Fix {
    pub height: u32,
    pub latitude: i32,
    pub longitude: i32,
}

/// Returns ten minutes over hills, every 100 ms, with a fix each second.
pub(super) fn drive() -> Vec<(Instant, Sent)> {
    let mut distance_m = 0.0_f64;
    (0..6000_u32)
        .map(|k| {
            let time_s = f64::from(k) * 0.1;
            let speed_mps = 20.0 + 3.0 * (time_s / 40.0).sin();
            let acceleration = 3.0 / 40.0 * (time_s / 40.0).cos();
            distance_m += 0.1 * speed_mps;
            let slope = 0.03 * (distance_m / 400.0).sin();
            let height_m = 400.0 + 12.0 * (1.0 - (distance_m / 400.0).cos());
            let resistance_n = 1500.0 * 9.81 * (slope + 0.01) + 0.42 * speed_mps * speed_mps;
            let force_n = resistance_n + 1550.0 * acceleration;
            let fix = k.is_multiple_of(10).then(|| Fix {
                height: ((height_m + 500.0) * 8.0).round() as u32,
                latitude: 473_000_000 + (distance_m * 89.9) as i32,
                longitude: -85_000_000 - (distance_m * 3.0) as i32,
            });
            let sent = Sent {
                force: (force_n * 2.0).round() as i16,
                braking: (3000..3040).contains(&k),
                speed: (speed_mps * 128.0).round() as u16,
                fix,
            };
            (
                Instant::from_micros(1_000_000 + u64::from(k) * 100_000),
                sent,
            )
        })
        .collect()
}

const COLUMNS: [Signal; 7] = [
    Signal::TractionForce,
    Signal::Satellites,
    Signal::Latitude,
    Signal::Longitude,
    Signal::Altitude,
    Signal::BrakeSwitch,
    Signal::WheelSpeed,
];

pub(super) fn write_table(path: &Path, drive: &[(Instant, Sent)]) {
    let rows = drive.iter().map(|(time, sent)| {
        let fix = sent.fix.as_ref();
        let values = [
            Some(f64::from(sent.force) * 0.5),
            fix.map(|_| 9.0),
            fix.map(|fix| f64::from(fix.latitude) * 1e-7),
            fix.map(|fix| f64::from(fix.longitude) * 1e-7),
            fix.map(|fix| f64::from(fix.height) * 0.125 - 500.0),
            Some(f64::from(u8::from(sent.braking))),
            Some(f64::from(sent.speed) / 128.0),
        ];
        (*time, values)
    });
    signal_table::write(path, &COLUMNS, rows).unwrap();
}

fn frames_of(sent: &Sent) -> Vec<CanFrame> {
    let frame = |id: u16, data: &[u8]| CanFrame::new(StandardId::new(id).unwrap(), data).unwrap();
    let [high, low] = sent.force.to_be_bytes();
    // The gear is not mapped; its nibble and the others are noise.
    let mut frames = vec![frame(257, &[high, low, 0xa5, 0x5a, 0xff, 0, 1, 2])];
    if let Some(fix) = &sent.fix {
        let page = |page: u8, number: i32| {
            let [a, b, c, d] = number.to_be_bytes();
            frame(300, &[page, a, b, c, d, 0, 0, 0])
        };
        let [_, a, b, c] = fix.height.to_be_bytes();
        frames.extend([
            page(2, fix.latitude),
            page(3, fix.longitude),
            frame(300, &[1, 9, a, b, c, 0, 0, 0]),
        ]);
    }
    let [high, low] = sent.speed.to_be_bytes();
    // 15 bits from bit 10: the low three of byte 1, byte 2, the high four of byte 3.
    let raw = u32::from(u16::from_be_bytes([high, low])) << 4;
    let [_, first, second, third] = raw.to_be_bytes();
    frames.push(frame(
        513,
        &[u8::from(sent.braking), 0xf8 | first, second, third | 0x0f],
    ));
    frames
}

fn write_log(path: &Path, drive: &[(Instant, Sent)]) {
    let mut text = Vec::new();
    for (time, sent) in drive {
        for frame in frames_of(sent) {
            let timed = TimedFrame { time: *time, frame };
            write_frame(&mut text, &timed, "can0").unwrap();
        }
    }
    std::fs::write(path, text).unwrap();
}

/// Writes vehicle, description, mapping, table and log of the drive.
fn car() -> tempfile::TempDir {
    let folder = folder();
    let write = |name: &str, text: &str| std::fs::write(folder.path().join(name), text).unwrap();
    write("car.toml", VEHICLE);
    write("car.dbc", DBC);
    write("signals.toml", SIGNALS);
    let drive = drive();
    write_table(&folder.path().join("table.csv"), &drive);
    write_log(&folder.path().join("car.log"), &drive);
    folder
}

pub(super) fn estimate(folder: &Path, log: &str, out: &str, options: &[&str]) -> String {
    program()
        .current_dir(folder)
        .args(["estimate", "--vehicle", "car.toml", "--out", out, log])
        .args(options)
        .assert()
        .success();
    std::fs::read_to_string(folder.join(out)).unwrap()
}

const OWN: [&str; 4] = ["--dbc", "car.dbc", "--signals", "signals.toml"];

#[test]
fn own_frames_give_the_cells_of_the_signal_table() {
    let folder = car();
    let of_table = estimate(folder.path(), "table.csv", "table.run.csv", &[]);
    let of_frames = estimate(folder.path(), "car.log", "car.run.csv", &OWN);
    assert!(of_table.lines().count() > 4_000, "12 km");
    assert!(of_table == of_frames, "byte-identical");
}

#[test]
fn an_own_signal_goes_before_that_of_a_built_in_message() {
    let folder = car();
    let alone = estimate(folder.path(), "car.log", "alone.csv", &OWN);
    // CCVS1 says half the speed, ten times a second.
    let log = folder.path().join("car.log");
    let mut text = String::new();
    for (k, line) in std::fs::read_to_string(&log).unwrap().lines().enumerate() {
        text += line;
        text.push('\n');
        if k % 3 == 2 {
            let (time, _) = line.split_once(' ').unwrap();
            text += &format!("{time} can0 18FEF100#FF00240000FFFFFF\n");
        }
    }
    std::fs::write(folder.path().join("both.log"), text).unwrap();
    let both = estimate(folder.path(), "both.log", "both.csv", &OWN);
    let speed = |run: &str| {
        let last = run.lines().last().unwrap().to_owned();
        last.split(',').nth(12).unwrap().parse::<f64>().unwrap()
    };
    assert!(
        (speed(&alone) - speed(&both)).abs() < 0.5,
        "{} {}",
        speed(&alone),
        speed(&both)
    );
    let distance = |run: &str| {
        let last = run.lines().last().unwrap().to_owned();
        last.split(',').nth(1).unwrap().to_owned()
    };
    assert_eq!(distance(&alone), distance(&both));
}

#[test]
fn inspect_lists_the_signals_of_a_dbc_and_proposes_a_mapping() {
    let folder = car();
    let inspect = |options: &[&str]| {
        let run = program()
            .current_dir(folder.path())
            .args(["inspect", "car.log", "--dbc", "car.dbc"])
            .args(options)
            .assert()
            .success();
        String::from_utf8(run.get_output().stdout.clone()).unwrap()
    };
    let text = inspect(&[]);
    for words in [
        "| Wheels",
        "VehicleSpeed",
        "[signals.wheel_speed_mps]",
        "scale = 1.0",
    ] {
        assert!(text.contains(words), "{words}\n{text}");
    }
    let json: serde_json::Value = serde_json::from_str(&inspect(&["--json"])).unwrap();
    let proposed = |signal: &str| {
        let all = json["dbc"]["proposal"].as_array().unwrap();
        let one = all.iter().find(|one| one["signal"] == signal);
        one.map(|one| one["source"].as_str().unwrap().to_owned())
    };
    for (signal, source) in [
        ("wheel_speed_mps", "VehicleSpeed"),
        ("traction_force_n", "WheelForce"),
        ("brake", "Braking"),
        ("gear", "Gear"),
        ("satellites", "Sats"),
        ("altitude_m", "Height"),
        ("latitude_deg", "Lat"),
        ("longitude_deg", "Lon"),
    ] {
        assert_eq!(proposed(signal).as_deref(), Some(source), "{signal}");
    }
    assert_eq!(proposed("engine_speed_rpm"), None);

    // The proposal works as it is, and gives the cells of the mapping that is made by hand.
    let toml = json["dbc"]["signals_toml"].as_str().unwrap();
    let without_gear = toml.replace("[signals.gear]", "[signals.selected_gear]");
    std::fs::write(folder.path().join("proposed.toml"), without_gear).unwrap();
    let options = ["--dbc", "car.dbc", "--signals", "proposed.toml"];
    let proposed = estimate(folder.path(), "car.log", "proposed.csv", &options);
    assert!(proposed == estimate(folder.path(), "car.log", "own.csv", &OWN));

    // With a mapping, the inspection shows what an estimate would use.
    let json: serde_json::Value =
        serde_json::from_str(&inspect(&["--signals", "signals.toml", "--json"])).unwrap();
    let signals = json["signals"].as_array().unwrap();
    assert!(
        signals
            .iter()
            .any(|s| s["signal"] == "wheel_speed_mps" && s["pgn"].is_null())
    );
}

#[test]
fn a_dbc_alone_is_no_mapping() {
    let folder = car();
    let estimate = |options: &[&str], code: i32, words: &str| {
        program()
            .current_dir(folder.path())
            .args([
                "estimate",
                "--vehicle",
                "car.toml",
                "--out",
                "x.csv",
                "car.log",
            ])
            .args(options)
            .assert()
            .code(code)
            .stderr(predicates::str::contains(words));
        assert!(!folder.path().join("x.csv").exists());
    };
    estimate(&["--dbc", "car.dbc"], 2, "--dbc without --signals");
    estimate(&["--signals", "signals.toml"], 2, "--dbc");
    estimate(
        &["--dbc", "car.dbc", "--signals", "none.toml"],
        1,
        "none.toml: ",
    );
    // Without the mapping, the log has nothing of use.
    estimate(&[], 1, "car.log: ");
}

#[test]
fn columns_lists_every_signal() {
    let run = |options: &[&str]| {
        let run = program().arg("columns").args(options).assert().success();
        String::from_utf8(run.get_output().stdout.clone()).unwrap()
    };
    let json: serde_json::Value = serde_json::from_str(&run(&["--json"])).unwrap();
    let columns = json.as_array().unwrap();
    assert_eq!(columns.len(), Signal::ALL.len());
    let speed = columns
        .iter()
        .find(|c| c["column"] == "wheel_speed_mps")
        .unwrap();
    assert_eq!(speed["unit"], "m/s");
    assert_eq!(speed["sources"][0]["spn"], 84);
    assert_eq!(speed["sources"][0]["pgn"], 65_265);
    assert_eq!(speed["sources"][0]["message"], "CCVS1");
    let altitude = columns
        .iter()
        .find(|c| c["column"] == "altitude_m")
        .unwrap();
    assert!(
        altitude["sources"]
            .as_array()
            .unwrap()
            .iter()
            .any(|s| s["bus"] == "NMEA 2000")
    );
    // Every message that the core decodes is somewhere in the list.
    for message in estimator_core::signal::messages() {
        let has = |c: &&serde_json::Value| {
            c["sources"]
                .as_array()
                .unwrap()
                .iter()
                .any(|s| s["pgn"] == message.pgn())
        };
        assert!(columns.iter().any(|c| has(&c)), "{}", message.name());
    }
    let text = run(&[]);
    assert!(text.contains("J1939 CCVS1 65265 SPN 84"), "{text}");
}

#[test]
fn ignored_columns_and_signals_that_no_frame_has_are_named_once() {
    let folder = car();
    let table = std::fs::read_to_string(folder.path().join("table.csv")).unwrap();
    let mut lines = table.lines();
    let mut wider = format!("{},driver\n", lines.next().unwrap());
    for line in lines {
        wider += &format!("{line},x\n");
    }
    std::fs::write(folder.path().join("wider.csv"), wider).unwrap();
    let stderr = |log: &str, options: &[&str]| {
        let run = program()
            .current_dir(folder.path())
            .args(["estimate", "--vehicle", "car.toml", "--out", "x.csv", log])
            .args(options)
            .assert()
            .success();
        String::from_utf8(run.get_output().stderr.clone()).unwrap()
    };
    let words = stderr("wider.csv", &[]);
    assert_eq!(
        words.matches("wider.csv: ignored columns: driver").count(),
        1,
        "{words}"
    );
    assert!(!stderr("table.csv", &[]).contains("ignored"));

    let more = "[signals.gear]\nmessage = 999\nsignal = \"Gear\"\n";
    std::fs::write(folder.path().join("more.toml"), format!("{SIGNALS}{more}")).unwrap();
    let dbc = format!("{DBC}BO_ 999 Box: 8 Car\n SG_ Gear : 0|8@1+ (1,0) [0|0] \"\" Car\n");
    std::fs::write(folder.path().join("more.dbc"), dbc).unwrap();
    let words = stderr("car.log", &["--dbc", "more.dbc", "--signals", "more.toml"]);
    let expected = "car.log: no frame has these signals of --signals: gear";
    assert!(words.contains(expected), "{words}");
}
