//! Drives on which nothing is wrong: no warning.

use crate::drive::{Table, estimate, estimate_log, simulate, table};
use estimator_core::Signal;
use std::fs;
use test_kit::command::{folder, program};

const NONE: [&str; 0] = [];

#[test]
fn the_drive_that_the_others_change() {
    let printed = estimate(&table());
    assert_eq!(printed.codes, NONE, "{printed:?}");
    assert!(!printed.stderr.contains("warning"), "{printed:?}");
    assert!(printed.json["warnings"].is_array(), "{printed:?}");
    // What the tests of wrong units change is there.
    let has = |signal| table().iter().any(|(_, row)| row.contains_key(&signal));
    for signal in [
        Signal::AirPressure,
        Signal::AmbientTemperature,
        Signal::Course,
        Signal::GnssSpeed,
        Signal::YawRate,
    ] {
        assert!(has(signal), "{signal:?}");
    }
}

#[test]
fn a_part_of_it_and_every_signal_missing_but_the_required_ones() {
    let short: Table = table();
    let end_s = short.last().unwrap().0;
    for part in [0.02, 0.05, 0.1, 0.3] {
        let rows = short
            .iter()
            .take_while(|(seconds, _)| *seconds < part * end_s);
        let printed = estimate(&rows.cloned().collect());
        assert_eq!(printed.codes, NONE, "{printed:?}");
        assert!(!printed.stderr.contains("warning"), "{printed:?}");
    }
    let required = [
        Signal::WheelSpeed,
        Signal::EngineTorque,
        Signal::FrictionTorque,
        Signal::CurrentGear,
        Signal::Altitude,
    ];
    let mut sparse = short;
    for (_, row) in &mut sparse {
        row.retain(|signal, _| required.contains(signal));
    }
    assert_eq!(estimate(&sparse).codes, NONE);
}

#[test]
fn the_scenarios_of_the_demo() {
    let folder = folder();
    simulate(folder.path(), include_str!("../../scenarios/demo.toml"));
    for name in ["a1", "a2", "a3", "b1", "b2"] {
        let file = |ending: &str| folder.path().join(format!("{name}.{ending}"));
        let printed = estimate_log(&file("vehicle.toml"), &file("log"));
        assert_eq!(printed.codes, NONE, "{name}: {printed:?}");
    }
}

#[test]
fn a_measured_bus() {
    let data = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shared/data/ztbus");
    let Ok(entries) = fs::read_dir(&data) else {
        eprintln!("skipped: no measured data in ../shared/data");
        return;
    };
    let mission = entries.filter_map(|entry| Some(entry.ok()?.path()));
    let mission = mission.filter(|path| path.extension().is_some_and(|ending| ending == "csv"));
    let folder = folder();
    for path in mission {
        program()
            .args(["import", "ztbus"])
            .arg(&path)
            .arg("--out")
            .arg(folder.path())
            .assert()
            .success();
    }
    let vehicle = folder.path().join("vehicle.toml");
    let tables = fs::read_dir(folder.path()).unwrap();
    let tables = tables.map(|entry| entry.unwrap().path());
    let mut count = 0;
    for table in tables.filter(|path| path.extension().is_some_and(|ending| ending == "csv")) {
        if table
            .file_name()
            .unwrap()
            .to_string_lossy()
            .contains("truth")
        {
            continue;
        }
        let printed = estimate_log(&vehicle, &table);
        assert_eq!(printed.codes, NONE, "{}: {printed:?}", table.display());
        count += 1;
    }
    assert!(count > 0);
}
