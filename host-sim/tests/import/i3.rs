//! `roadgrade import i3`: tables, what is left out and said, and unusable files.

use crate::shared;
use assert_cmd::Command;
use flate2::Compression;
use flate2::write::GzEncoder;
use host_sim::files::vehicle::VehicleFile;
use host_sim::source::i3::Trip;
use predicates::str::contains;
use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};
use test_kit::command::program;
use test_kit::tables::columns;

/// Columns as they are published, and one that does not matter.
const HEADER: [&str; 7] = [
    "Time [s]",
    "Velocity [km/h]",
    "Elevation [m]",
    "Motor Torque [Nm]",
    "Longitudinal Acceleration [m/s^2]",
    "Regenerative Braking Signal ",
    "Ambient Temperature [°C]",
];
/// Rows of a trip: 360 s, which end within a line of the elevation.
const ROWS: usize = 3_600;
/// Rows between two points of the elevation.
const POINT_ROWS: usize = 1_000;
/// Points of the elevation, m.
const POINTS_M: [f64; 5] = [500.0, 507.0, 503.0, 503.0, 511.0];

/// Returns the fields of a row, in the order of the header.
fn fields(row: usize) -> Vec<String> {
    let time_s = row as f64 / 10.0;
    let (point, behind) = (row / POINT_ROWS, row % POINT_ROWS);
    let share = behind as f64 / POINT_ROWS as f64;
    let rise_m = POINTS_M[point + 1] - POINTS_M[point];
    let wave = (0.2 * time_s).sin();
    // Digits that no line explains.
    let noise = 0.05 * ((row * 7919) % 11) as f64;
    [
        time_s,
        54.0 + 18.0 * wave,
        POINTS_M[point] + share * rise_m,
        40.0 + 60.0 * (0.2 * time_s).cos() + noise,
        (0.2 * time_s).cos() + noise,
        0.0,
        21.5,
    ]
    .iter()
    .map(|value| format!("{value:.2}"))
    .collect()
}

/// Returns a trip's file in Latin-1 with CR LF, after `change` of the fields of each line.
fn trip(change: impl Fn(usize, &mut Vec<String>)) -> Vec<u8> {
    let mut text = String::new();
    for line in 0..=ROWS - 1 {
        let mut fields = match line.checked_sub(1) {
            None => HEADER.map(str::to_owned).to_vec(),
            Some(row) => fields(row),
        };
        change(line + 1, &mut fields);
        text += &(fields.join(";") + "\r\n");
    }
    // Latin-1 has the bytes of the first 256 characters.
    text.chars().map(|c| c as u32 as u8).collect()
}

fn plain() -> Vec<u8> {
    trip(|_, _| ())
}

fn import(files: &[&Path], out: &Path) -> Command {
    let mut command = program();
    command.args(["import", "i3"]).args(files);
    command.arg("--out").arg(out);
    command
}

/// Imports one trip. Returns the folder and the table.
fn imported(content: &[u8], said: &str) -> (tempfile::TempDir, PathBuf) {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("TripA01.csv");
    fs::write(&file, content).unwrap();
    let out = folder.path().join("out");
    import(&[&file], &out)
        .assert()
        .success()
        .stderr(contains(said));
    (folder, out.join("TripA01.csv"))
}

fn numbers(table: &Path, column: &str) -> Vec<f64> {
    let fields = &columns(table)[column];
    fields
        .iter()
        .filter_map(|field| field.parse().ok())
        .collect()
}

#[test]
fn a_trip_becomes_a_table_and_a_vehicle() {
    let (folder, table) = imported(&plain(), "its 4 points are kept");
    assert_eq!(numbers(&table, "time_s").len(), ROWS - 1);
    let speeds = numbers(&table, "wheel_speed_mps");
    assert!((speeds[0] - 15.0).abs() < 1e-4, "{}", speeds[0]);
    assert!((numbers(&table, "motor_torque_nm")[0] - 100.0).abs() < 0.01);
    assert!((numbers(&table, "longitudinal_acceleration_mps2")[0] - 1.0).abs() < 0.01);
    assert!(
        numbers(&table, "ambient_celsius")
            .iter()
            .all(|c| *c == 21.5)
    );
    assert!(numbers(&table, "mass_kg").iter().all(|kg| *kg == 1_440.0));

    let out = folder.path().join("out");
    let vehicle = VehicleFile::read(&out.join("vehicle.toml")).unwrap();
    assert_eq!(vehicle.model.vehicle.mass_kg, 1_440.0);
    assert_eq!(vehicle.model.vehicle.drag_area_m2, 0.69);
    program()
        .args(["estimate", "--vehicle"])
        .arg(out.join("vehicle.toml"))
        .arg("--out")
        .arg(out.join("run.csv"))
        .arg(&table)
        .assert()
        .success();
}

#[test]
fn elevation_counts_where_it_was_measured() {
    let (_folder, table) = imported(&plain(), "minutes apart");
    let fields = &columns(&table)["altitude_m"];
    let known = fields
        .iter()
        .enumerate()
        .filter(|(_, field)| !field.is_empty());
    let known: Vec<(usize, f64)> = known.map(|(row, of)| (row, of.parse().unwrap())).collect();
    let altitudes: Vec<f64> = known.iter().map(|of| of.1).collect();
    assert_eq!(altitudes, POINTS_M[..4]);
    for ((row, _), expected) in known.iter().zip((0..).step_by(POINT_ROWS)) {
        assert!(row.abs_diff(expected) <= 5, "{row} {expected}");
    }
}

#[test]
fn elevation_that_changes_all_the_time_is_thinned() {
    let rough = trip(|line, fields| {
        if line > 1 {
            fields[2] = format!("{:.2}", 500.0 + ((line * 7919) % 97) as f64 * 0.1);
        }
    });
    let (_folder, table) = imported(&rough, "every 5 s");
    let altitudes = numbers(&table, "altitude_m");
    assert!((70..=75).contains(&altitudes.len()), "{}", altitudes.len());
}

#[test]
fn frozen_elevation_is_no_measurement() {
    for frozen in ["582.00", "0"] {
        let still = trip(|line, fields| {
            if line > 1 {
                fields[2] = frozen.to_owned();
            }
        });
        let (_folder, table) = imported(&still, "all along: no measurement, left out");
        assert!(!columns(&table).contains_key("altitude_m"));
    }
}

#[test]
fn columns_may_stand_in_another_order_and_be_missing() {
    let (_folder, whole) = imported(&plain(), "");
    let turned = trip(|_, fields| fields.reverse());
    let (_other, table) = imported(&turned, "");
    assert_eq!(fs::read(&table).unwrap(), fs::read(&whole).unwrap());

    let few = trip(|_, fields| fields.truncate(2));
    let (_third, table) = imported(&few, "no column `Motor Torque`: no force for the model");
    let found = columns(&table);
    assert!(found.contains_key("wheel_speed_mps") && !found.contains_key("motor_torque_nm"));
}

#[test]
fn a_packed_trip_is_the_same_trip() {
    let (_folder, whole) = imported(&plain(), "");
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("TripA01.csv.gz");
    let mut packer = GzEncoder::new(Vec::new(), Compression::fast());
    packer.write_all(&plain()).unwrap();
    let packed = packer.finish().unwrap();
    fs::write(&file, &packed).unwrap();
    let out = folder.path().join("out");
    import(&[&file], &out).assert().success();
    let table = fs::read(out.join("TripA01.csv")).unwrap();
    assert_eq!(table, fs::read(&whole).unwrap());

    fs::write(&file, &packed[..packed.len() / 2]).unwrap();
    let again = folder.path().join("again");
    import(&[&file], &again)
        .assert()
        .code(1)
        .stderr(contains("TripA01.csv.gz"));
    assert!(!again.exists());
}

#[test]
fn a_gap_over_which_all_runs_straight_is_left_out() {
    let (from, to) = (1_200, 2_150);
    let (first, last) = (fields(from), fields(to));
    let gap = trip(|line, fields| {
        let Some(row) = line.checked_sub(2).filter(|row| (from..to).contains(row)) else {
            return;
        };
        let share = (row - from) as f64 / (to - from) as f64;
        for k in [1, 3, 4] {
            let [a, b]: [f64; 2] = [&first, &last].map(|of| of[k].parse().unwrap());
            fields[k] = format!("{:.2}", a + share * (b - a));
        }
    });
    let (_folder, table) = imported(&gap, "120 to 215 s: all signals run straight over a gap");
    let times = numbers(&table, "time_s");
    let longest = times
        .windows(2)
        .map(|two| two[1] - two[0])
        .fold(0.0, f64::max);
    assert!((longest - 95.0).abs() < 1e-6, "{longest}");
}

/// Checks that a file is refused with this message, and that nothing is written.
fn refused(content: &[u8], message: &[&str]) {
    let folder = tempfile::tempdir().unwrap();
    let good = folder.path().join("TripA01.csv");
    let bad = folder.path().join("TripB01.csv");
    fs::write(&good, plain()).unwrap();
    fs::write(&bad, content).unwrap();
    let out = folder.path().join("out");
    let mut run = import(&[&good, &bad], &out).assert().code(1);
    for part in message {
        run = run.stderr(contains(*part));
    }
    run.stdout("");
    assert!(
        !out.exists(),
        "output of an import that failed: {message:?}"
    );
}

#[test]
fn unusable_trips_are_refused_by_file_and_line() {
    let at = |at: usize, column: usize, text: &'static str| {
        trip(move |line, fields| {
            if line == at {
                text.clone_into(&mut fields[column]);
            }
        })
    };
    refused(b"", &["TripB01.csv", "empty"]);
    refused(b"a,b\n1,2\n", &["TripB01.csv:1", "no column `Time`"]);
    refused(
        &at(1, 1, "Speed"),
        &["TripB01.csv:1", "no column `Velocity`"],
    );
    refused(
        &at(1, 1, "Velocity [m/s]"),
        &["TripB01.csv:1", "Velocity [km/h]"],
    );
    refused(&at(1, 2, "Time [s]"), &["TripB01.csv:1", "repeated"]);
    for text in ["fast", "inf", "1e999", "-80", "12,5"] {
        refused(
            &at(20, 1, text),
            &["TripB01.csv:20", "Velocity is", "expected a number"],
        );
    }
    refused(
        &at(20, 6, "294.6"),
        &["TripB01.csv:20", "Ambient Temperature is"],
    );
    refused(&at(20, 0, ""), &["TripB01.csv:20", "Time is missing"]);
    refused(
        &at(20, 0, "0.4"),
        &["TripB01.csv:20", "times that increase"],
    );
    refused(
        &trip(|line, fields| fields.truncate(if line == 31 { 4 } else { 7 })),
        &["TripB01.csv:31", "4 fields", "expected 7"],
    );
    refused(
        &trip(|line, fields| {
            if line > 1 {
                fields[1].clear();
            }
        }),
        &["TripB01.csv", "no row has a velocity"],
    );
    refused(&[0xff, 0xfe, 0x00, b';', b'\n'], &["TripB01.csv:1"]);
}

#[test]
fn two_trips_of_one_name_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let files = ["a", "b"].map(|name| folder.path().join(name).join("TripA01.csv"));
    for file in &files {
        fs::create_dir(file.parent().unwrap()).unwrap();
        fs::write(file, plain()).unwrap();
    }
    let out = folder.path().join("out");
    import(&[&files[0], &files[1]], &out)
        .assert()
        .code(1)
        .stderr(contains("is trip TripA01 as"));
    assert!(!out.exists());
}

#[test]
fn wrong_usage_ends_with_2() {
    program()
        .args(["import", "i3", "--out", "x"])
        .assert()
        .code(2);
    program().args(["import", "i3", "x.csv"]).assert().code(2);
}

#[test]
fn the_measured_trips_are_read_as_they_are_published() {
    let Some(folder) = shared("i3") else {
        return;
    };
    let trip = |name: &str| Trip::read(&folder.join(format!("{name}.csv.gz"))).unwrap();
    let altitudes = |trip: &Trip| -> Vec<f64> {
        let rows = trip.rows().iter();
        rows.filter_map(|row| row.altitude_m).collect()
    };
    let long = trip("TripA06");
    assert_eq!(long.rows().len(), 31_645);
    assert!(
        (long.length_m() - 45_993.0).abs() < 10.0,
        "{}",
        long.length_m()
    );
    assert_eq!(altitudes(&long).len(), 10);
    assert!(
        altitudes(&long)
            .iter()
            .all(|altitude_m| altitude_m.fract() == 0.0)
    );
    assert!(altitudes(&trip("TripA04")).is_empty());
    let torn = trip("TripB02");
    assert!(
        torn.notes()
            .iter()
            .any(|note| note.contains("39.3 to 199.1 s"))
    );
    assert!(
        torn.rows()
            .windows(2)
            .any(|two| two[1].time_s - two[0].time_s > 150.0)
    );
}
