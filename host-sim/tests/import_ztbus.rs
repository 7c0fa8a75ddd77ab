//! `roadgrade import ztbus`: passes, tables, and files that cannot be used.

mod ztbus_mission;

use assert_cmd::Command;
use host_sim::source::terrain::Terrain;
use host_sim::source::ztbus::{Mission, round_trips};
use host_sim::study::drift::{ForceSample, vehicle_model_drift};
use host_sim::vehicle_file::VehicleFile;
use predicates::prelude::*;
use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use tempfile::TempDir;
use ztbus_mission::{HEADER, MissionMaker, Point};

fn import(file: &Path, out: &Path) -> Command {
    let mut command = Command::cargo_bin("roadgrade").unwrap();
    command.args(["import", "ztbus"]).arg(file);
    command.arg("--out").arg(out);
    command
}

/// A folder with the mission's file in it, and where its import is to go.
fn folder_with(text: &str) -> (TempDir, PathBuf, PathBuf) {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("B183_2021-07-26_03-53-27.csv");
    fs::write(&file, text).unwrap();
    let out = folder.path().join("out");
    (folder, file, out)
}

struct Imported {
    passes: Vec<serde_json::Value>,
    out: PathBuf,
    _folder: TempDir,
}

impl Imported {
    fn of(text: &str) -> Self {
        let (folder, file, out) = folder_with(text);
        let run = import(&file, &out).arg("--json").assert().success();
        let json: serde_json::Value = serde_json::from_slice(&run.get_output().stdout).unwrap();
        Self {
            passes: json["passes"].as_array().unwrap().clone(),
            out,
            _folder: folder,
        }
    }

    fn directions(&self) -> Vec<&str> {
        self.passes
            .iter()
            .map(|pass| pass["direction"].as_str().unwrap())
            .collect()
    }

    fn lengths_m(&self) -> Vec<f64> {
        self.passes
            .iter()
            .map(|pass| pass["length_m"].as_f64().unwrap())
            .collect()
    }
}

/// A signal table as text by column.
fn columns(path: &Path) -> BTreeMap<String, Vec<String>> {
    let mut reader = csv::Reader::from_path(path).unwrap();
    let names = reader.headers().unwrap().clone();
    let mut columns: BTreeMap<String, Vec<String>> = BTreeMap::new();
    for record in reader.records() {
        for (name, field) in names.iter().zip(&record.unwrap()) {
            columns
                .entry(name.to_owned())
                .or_default()
                .push(field.to_owned());
        }
    }
    columns
}

/// What every pass table must be: numbers only, time from 0 upwards, fixes, way as said.
fn check_pass_tables(passes: &[serde_json::Value]) {
    for pass in passes {
        let table = columns(Path::new(pass["file"].as_str().unwrap()));
        for (name, fields) in &table {
            for field in fields.iter().filter(|field| !field.is_empty()) {
                let value: f64 = field.parse().unwrap();
                assert!(value.is_finite(), "{name}: {field}");
            }
        }
        let numbers =
            |name: &str| -> Vec<f64> { table[name].iter().map(|v| v.parse().unwrap()).collect() };
        let time_s = numbers("time_s");
        assert_eq!(time_s[0], 0.0);
        assert!(time_s.windows(2).all(|two| two[1] > two[0]));
        assert!(table["latitude_deg"].iter().all(|field| !field.is_empty()));
        let speed_mps = numbers("wheel_speed_mps");
        let way_m: f64 = time_s
            .windows(2)
            .zip(speed_mps.windows(2))
            .map(|(t, v)| 0.5 * (v[0] + v[1]) * (t[1] - t[0]))
            .sum();
        let length_m = pass["length_m"].as_f64().unwrap();
        assert!((way_m - length_m).abs() < 1.0, "{way_m} {length_m}");
    }
}

const GARAGE: Point = (-700.0, 1_900.0);
const A: Point = (0.0, 0.0);
const MIDDLE: Point = (1_400.0, 700.0);
const B: Point = (3_000.0, 1_500.0);
/// Length of the straight road from A to B, m.
const ROAD_M: f64 = 3_354.0;

/// Out of the garage, three times there and back, and home by another road.
fn there_and_back() -> String {
    let mut bus = MissionMaker::new(GARAGE, 40)
        .wait(60, 0)
        .drive(&[(-700.0, 0.0), A]);
    for trip in 0..3 {
        bus = bus
            .wait(150, 4 + trip)
            .drive(&[MIDDLE])
            .wait(25, 10)
            .drive(&[B])
            .wait(200, 20)
            .drive(&[MIDDLE])
            .wait(15, 8)
            .drive(&[A]);
    }
    bus.wait(130, 0)
        .drive(&[(300.0, -600.0), (-1_500.0, -600.0), GARAGE])
        .wait(60, 0)
        .text()
}

#[test]
fn three_round_trips_are_six_passes() {
    let imported = Imported::of(&there_and_back());
    assert_eq!(
        imported.directions(),
        [
            "outbound", "inbound", "outbound", "inbound", "outbound", "inbound"
        ]
    );
    for length_m in imported.lengths_m() {
        assert!((length_m - ROAD_M).abs() < 20.0, "{length_m}");
    }
    for (pass, climb_m) in imported.passes.iter().zip([60.0, -60.0].iter().cycle()) {
        let found_m = pass["climb_m"].as_f64().unwrap();
        assert!((found_m - climb_m).abs() < 1.0, "{found_m}");
    }
    check_pass_tables(&imported.passes);
    // Passengers are those of the last count: a pass starts with those that got on.
    let first = &imported.passes[0];
    let table = columns(Path::new(first["file"].as_str().unwrap()));
    let counts: Vec<&str> = table["passengers"].iter().map(String::as_str).collect();
    let at = counts.len() / 3;
    assert_eq!((counts[at], table["mass_kg"][at].as_str()), ("4", "19280"));
}

#[test]
fn the_whole_mission_is_a_signal_table_with_a_vehicle() {
    let text = there_and_back();
    let imported = Imported::of(&text);
    let table = columns(&imported.out.join("mission.csv"));
    assert_eq!(table["time_s"].len(), text.lines().count() - 1);
    for (name, expected) in [
        ("time_s", "0"),
        ("wheel_speed_mps", "0"),
        ("traction_force_n", "0"),
        ("brake", "1"),
        ("brake_pressure_pa", "240000"),
        ("ambient_celsius", "22"),
        ("mass_kg", "19000"),
        // Nothing was measured yet.
        ("latitude_deg", ""),
        ("longitude_deg", ""),
        ("altitude_m", ""),
        ("course_deg", ""),
        ("passengers", ""),
    ] {
        assert_eq!(table[name][0], expected, "{name}");
    }
    let moving = table["wheel_speed_mps"]
        .iter()
        .position(|speed| speed == "11")
        .unwrap();
    assert_eq!(table["brake"][moving], "0");
    assert_eq!(table["traction_force_n"][moving], "2500.5");
    assert_eq!(table["course_deg"][moving], "180", "southwards");
    let latitude_deg: f64 = table["latitude_deg"][moving].parse().unwrap();
    assert!((latitude_deg - 47.33).abs() < 0.05, "{latitude_deg}");
    let vehicle = VehicleFile::read(&imported.out.join("vehicle.toml")).unwrap();
    assert_eq!(vehicle.name, "ZTBus B183");
    assert_eq!(vehicle.parameters.mass_kg, 19_000.0);
}

#[test]
fn the_table_lists_what_the_json_lists() {
    let (_folder, file, out) = folder_with(&there_and_back());
    import(&file, &out)
        .assert()
        .success()
        .stdout(predicate::str::contains("pass_06_inbound.csv"))
        .stdout(predicate::str::contains("direction"))
        .stderr(predicate::str::contains("first fix after 40 s"));
}

#[test]
fn the_same_mission_gives_the_same_bytes() {
    let (_folder, file, out) = folder_with(&there_and_back());
    let again = out.with_file_name("again");
    import(&file, &out).assert().success();
    import(&file, &again).assert().success();
    let mut names = 0;
    for entry in fs::read_dir(&out).unwrap() {
        let entry = entry.unwrap();
        let other = again.join(entry.file_name());
        assert!(fs::read(entry.path()).unwrap() == fs::read(other).unwrap());
        names += 1;
    }
    assert_eq!(names, 8, "mission, vehicle and six passes");
}

#[test]
fn a_bent_road_with_a_turning_loop_and_a_one_way_street_is_split_too() {
    let bend = (2_500.0, 0.0);
    let top = (2_500.0, 2_000.0);
    let out = [(800.0, 0.0), bend, top];
    // Around a block of 400 m, and home past a block that has a one-way street.
    let back = [
        (2_700.0, 2_000.0),
        (2_700.0, 1_800.0),
        (2_500.0, 1_800.0),
        bend,
        (1_500.0, 0.0),
        (1_500.0, 200.0),
        (800.0, 200.0),
        (800.0, 0.0),
        A,
    ];
    let mut bus = MissionMaker::new(A, 0).wait(90, 0);
    for _ in 0..2 {
        bus = bus.drive(&out).wait(60, 0).drive(&back).wait(60, 0);
    }
    let imported = Imported::of(&bus.drive(&out).wait(60, 0).text());
    assert_eq!(
        imported.directions(),
        ["outbound", "inbound", "outbound", "inbound", "outbound"]
    );
    for (length_m, expected_m) in imported
        .lengths_m()
        .iter()
        .zip([4_500.0, 5_300.0].iter().cycle())
    {
        assert!((length_m - expected_m).abs() < 30.0, "{length_m}");
    }
    check_pass_tables(&imported.passes);
}

#[test]
fn a_change_of_route_is_no_pass() {
    let (c, d) = ((9_000.0, -4_000.0), (9_000.0, 1_000.0));
    let mut bus = MissionMaker::new(A, 0).wait(30, 0);
    for _ in 0..2 {
        bus = bus.drive(&[B]).wait(100, 0).drive(&[A]).wait(100, 0);
    }
    bus = bus.drive(&[(1_000.0, -4_000.0), c]).wait(100, 0);
    for _ in 0..2 {
        bus = bus.drive(&[d]).wait(100, 0).drive(&[c]).wait(100, 0);
    }
    let imported = Imported::of(&bus.text());
    let lengths_m = imported.lengths_m();
    assert_eq!(lengths_m.len(), 8, "{lengths_m:?}");
    for (index, length_m) in lengths_m.iter().enumerate() {
        let expected_m = if index < 4 { ROAD_M } else { 5_000.0 };
        assert!((length_m - expected_m).abs() < 30.0, "{lengths_m:?}");
    }
}

#[test]
fn one_round_trip_is_two_passes() {
    let bus = MissionMaker::new(A, 5).wait(30, 0);
    let text = bus.drive(&[B]).wait(100, 0).drive(&[A]).wait(20, 0).text();
    let imported = Imported::of(&text);
    assert_eq!(imported.directions(), ["outbound", "inbound"]);
    for length_m in imported.lengths_m() {
        assert!((length_m - ROAD_M).abs() < 100.0, "{length_m}");
    }
}

#[test]
fn a_drive_that_never_turns_back_is_one_pass_from_the_first_fix() {
    let square = [(2_000.0, 0.0), (2_000.0, 2_000.0), (0.0, 2_000.0), A];
    let text = MissionMaker::new(A, 50)
        .wait(30, 0)
        .drive(&square)
        .drive(&square)
        .text();
    let imported = Imported::of(&text);
    assert_eq!(imported.directions(), ["outbound"]);
    assert_eq!(imported.passes[0]["start_s"].as_f64(), Some(50.0));
    assert!(imported.lengths_m()[0] > 15_500.0);
    check_pass_tables(&imported.passes);
}

/// The import ends with 1, says what `message` says, and writes nothing.
fn refused(text: impl AsRef<[u8]>, message: &[&str]) {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("mission.csv");
    let out = folder.path().join("out");
    fs::write(&file, text).unwrap();
    let mut run = import(&file, &out).assert().code(1);
    for part in message {
        run = run.stderr(predicate::str::contains(*part));
    }
    run.stdout("");
    assert!(!out.exists(), "output of an import that failed");
}

/// A short mission, with line `line` changed by `change`.
fn damaged(line: usize, change: impl Fn(&str) -> String) -> String {
    let text = MissionMaker::new(A, 3).wait(10, 0).drive(&[MIDDLE]).text();
    let lines = text.lines().zip(1..);
    lines
        .map(|(content, number)| {
            if number == line {
                change(content) + "\n"
            } else {
                format!("{content}\n")
            }
        })
        .collect()
}

#[test]
fn other_files_are_refused() {
    refused("", &["mission.csv:1", "no column time_unix"]);
    refused("a,b\n1,2\n", &["mission.csv:1", "odometry_vehicleSpeed"]);
    refused(
        damaged(1, |header| {
            header.replace("traction_brakePressure", "brake")
        }),
        &["mission.csv:1", "no column traction_brakePressure"],
    );
    refused([0xff_u8, 0xfe, 0x00, b',', b'\n'], &["mission.csv:1"]);
    refused(
        format!("{HEADER}\n"),
        &["mission.csv", "gnss_latitude", "expected"],
    );
}

#[test]
fn a_missing_file_is_named() {
    let folder = tempfile::tempdir().unwrap();
    import(&folder.path().join("nowhere.csv"), folder.path())
        .assert()
        .code(1)
        .stderr(predicate::str::contains("nowhere.csv"));
}

#[test]
fn truncated_lines_are_refused() {
    refused(
        damaged(9, |line| line[..line.len() / 2].to_owned()),
        &["mission.csv:9", "fields", "expected 16"],
    );
    let whole = damaged(0, str::to_owned);
    let cut = whole.trim_end().rfind(',').unwrap() - 3;
    refused(&whole[..cut], &["mission.csv:", "expected 16"]);
}

#[test]
fn what_is_no_number_is_refused() {
    for (bad, column) in [
        ("2500.5", "traction_tractionForce"),
        ("295.15", "temperature_ambient"),
    ] {
        for replacement in ["fast", "inf", "", "1e999", "0x10"] {
            refused(
                damaged(14, |line| line.replace(bad, replacement)),
                &["mission.csv:14", column, "expected a number"],
            );
        }
    }
}

#[test]
fn positions_in_degrees_are_refused() {
    refused(
        damaged(14, |line| line.replace(",0.82", ",47.32")),
        &["mission.csv:14", "gnss_latitude", "rad"],
    );
}

#[test]
fn time_that_stands_or_goes_back_is_refused() {
    for time in ["1600000005", "1600000010", "1599999999"] {
        refused(
            damaged(13, |line| line.replace("1600000011", time)),
            &["mission.csv:13", "time_unix does not increase"],
        );
    }
}

#[test]
fn a_mission_without_gnss_is_refused() {
    let text = MissionMaker::new(A, u32::MAX)
        .wait(10, 0)
        .drive(&[B])
        .text();
    refused(text, &["mission.csv", "expected a mission with GNSS"]);
}

#[test]
fn wrong_usage_ends_with_2() {
    let mut command = Command::cargo_bin("roadgrade").unwrap();
    command.args(["import", "ztbus", "x.csv"]).assert().code(2);
}

/// The measured mission beside the project, if it is there.
fn shared(name: &str) -> Option<PathBuf> {
    let data = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shared/data");
    let path = data.join(name);
    if !path.exists() {
        eprintln!("SKIPPED: no measured data at ../shared/data/{name}");
        return None;
    }
    Some(path)
}

fn measured_mission() -> Option<PathBuf> {
    let mut files: Vec<PathBuf> = fs::read_dir(shared("ztbus")?)
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .filter(|path| path.extension().is_some_and(|e| e == "csv"))
        .collect();
    files.sort();
    files.into_iter().next()
}

#[test]
fn the_measured_mission_is_three_round_trips_between_the_ways_from_and_to_the_garage() {
    let Some(file) = measured_mission() else {
        return;
    };
    let folder = tempfile::tempdir().unwrap();
    let run = import(&file, folder.path())
        .arg("--json")
        .assert()
        .success();
    let json: serde_json::Value = serde_json::from_slice(&run.get_output().stdout).unwrap();
    assert_eq!(json["rows"], 12_321);
    assert_eq!(json["first_fix_s"], 692.0);
    let passes = json["passes"].as_array().unwrap();
    assert_eq!(passes.len(), 6);
    for (pass, direction) in passes.iter().zip(["outbound", "inbound"].iter().cycle()) {
        assert_eq!(pass["direction"], *direction);
        let length_m = pass["length_m"].as_f64().unwrap();
        assert!((7_250.0..7_350.0).contains(&length_m), "{length_m}");
        let climb_m = pass["climb_m"].as_f64().unwrap();
        assert!((60.0..80.0).contains(&climb_m.abs()), "{climb_m}");
    }
    check_pass_tables(passes);
}

#[test]
fn the_bare_model_drifts_on_the_measured_mission_as_is_known() {
    let Some(file) = measured_mission() else {
        return;
    };
    let mission = Mission::read(&file).unwrap();
    let vehicle = mission.vehicle().parameters;
    let trips = round_trips(&mission.passes());
    assert_eq!(trips.len(), 3);
    for rows in trips {
        let samples: Vec<ForceSample> = mission.rows()[rows]
            .iter()
            .map(|row| ForceSample {
                time_s: row.time_s,
                speed_mps: row.speed_mps.unwrap(),
                traction_force_n: row.traction_force_n.unwrap(),
                mass_kg: Some(row.mass_kg()),
                ambient_celsius: row.ambient_celsius,
                air_pressure_pa: None,
            })
            .collect();
        let drift = vehicle_model_drift(&samples, &vehicle, 0.0).unwrap();
        println!("{drift:?}");
        assert!((14_500.0..14_700.0).contains(&drift.length_m), "{drift:?}");
        assert!((3.5..6.0).contains(&drift.drift_m_per_km), "{drift:?}");
    }
}

#[test]
fn the_ground_is_where_the_bus_says() {
    let (Some(file), Some(folder)) = (measured_mission(), shared("srtm")) else {
        return;
    };
    let mission = Mission::read(&file).unwrap();
    let mut terrain = Terrain::new(&folder);
    // The mean of all passes in squares of about 20 m: one pass alone is off by 5 m.
    let mut squares: BTreeMap<(i64, i64), (f64, f64, f64)> = BTreeMap::new();
    let passes = mission.passes();
    let rows = passes
        .iter()
        .flat_map(|pass| &mission.rows()[pass.rows.clone()]);
    for row in rows.filter(|row| row.speed_mps.is_some_and(|mps| mps > 1.0)) {
        let (lat, lon) = row.position_deg().unwrap();
        let ground_m = terrain.altitude_m(lat, lon).unwrap().unwrap();
        let square = ((lat / 2e-4) as i64, (lon / 3e-4) as i64);
        let sum = squares.entry(square).or_default();
        sum.0 += row.altitude_m.unwrap();
        sum.1 += ground_m;
        sum.2 += 1.0;
    }
    let differences: Vec<f64> = squares
        .values()
        .filter(|(.., count)| *count >= 6.0)
        .map(|(gnss, ground, count)| (gnss - ground) / count)
        .collect();
    let count = differences.len() as f64;
    let mean_m = differences.iter().sum::<f64>() / count;
    let variance = differences
        .iter()
        .map(|d| (d - mean_m).powi(2))
        .sum::<f64>()
        / count;
    println!(
        "GNSS less SRTM: {mean_m:.1} m, sigma {:.1} m, {count} squares",
        variance.sqrt()
    );
    assert!(count > 300.0);
    assert!(variance.sqrt() < 6.0, "{}", variance.sqrt());
    assert!(mean_m.abs() < 15.0, "{mean_m}");
}
