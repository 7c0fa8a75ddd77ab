//! Signal tables that other programs write: delimiters, decimal commas, units, times and names.

use crate::signal_table::{read, read_with};
use estimator_core::{Signal, Value};
use host_sim::source::read_options::ReadOptions;
use host_sim::source::signal_table::ColumnsFile;
use std::sync::Arc;
use test_kit::command::{folder, roadgrade};

const SPEED: Signal = Signal::WheelSpeed;

/// Returns times and speeds.
fn speeds(content: &str) -> Vec<(u64, f32)> {
    speeds_of(read(content.as_bytes()).expect("a table"))
}

fn speeds_of(rows: Vec<(u64, Vec<(Signal, Value)>)>) -> Vec<(u64, f32)> {
    let speed = |readings: Vec<(Signal, Value)>| {
        let mut speeds = readings.into_iter().filter(|(signal, _)| *signal == SPEED);
        speeds.next().and_then(|(_, value)| value.real())
    };
    rows.into_iter()
        .map(|(time, readings)| (time, speed(readings).unwrap_or(f32::NAN)))
        .collect()
}

fn with_columns(columns: &str, content: &str) -> Result<Vec<(u64, f32)>, String> {
    let folder = folder();
    let path = folder.path().join("columns.toml");
    std::fs::write(&path, columns).unwrap();
    let columns = ColumnsFile::read(&path).map_err(|e| e.to_string())?;
    let options = ReadOptions {
        columns: Some(Arc::new(columns)),
        ..ReadOptions::default()
    };
    read_with(content.as_bytes(), &options).map(speeds_of)
}

#[test]
fn semicolons_tabs_and_decimal_commas_are_read() {
    let expected = [(0, 10.5), (100_000, 11.0)];
    for table in [
        "time_s;wheel_speed_mps\n0,0;10,5\n0,1;11\n",
        "sep=;\r\ntime_s;wheel_speed_mps\r\n0,0;10,5\r\n0,1;11\r\n",
        "time_s;wheel_speed_mps\n0.0;10.5\n0.1;11\n",
        "time_s\twheel_speed_mps\n0,0\t10,5\n0,1\t11\n",
        "# made by a logger\n\"time_s\";\"wheel_speed_mps\"\n\"0,0\";\"10,5\"\n\n0,1;11\n",
        "time_s;wheel_speed_mps\ns;m/s\n0,0;10,5\n0,1;11\n",
    ] {
        assert_eq!(speeds(table), expected, "{table}");
    }
    // A comma beside points separates thousands, or it does not: no one knows.
    let mixed = "time_s;wheel_speed_mps\n0.0;10.5\n0.1;1,100\n";
    assert!(read(mixed.as_bytes()).unwrap_err().contains("`1,100`"));
}

#[test]
fn units_in_headers_are_converted() {
    for header in [
        "time_s,wheel_speed [km/h]",
        "time_s,wheel_speed_mps [km/h]",
        "time_s,Wheel speed (km/h)",
        "time [s],wheel_speed [kph]",
    ] {
        let table = format!("{header}\n0,36\n0.1,72\n");
        assert_eq!(speeds(&table), [(0, 10.0), (100_000, 20.0)], "{header}");
    }
    let below = "time_s;wheel_speed_mps\ns;km/h\n0;36\n";
    assert_eq!(speeds(below), [(0, 10.0)]);
    // A unit of another quantity is no speed.
    let torque = "time_s,wheel_speed_mps [Nm],altitude_m\n0,36,4\n";
    let rows = read(torque.as_bytes()).unwrap();
    assert_eq!(rows[0].1, [(Signal::Altitude, Value::Real(4.0))]);
}

#[test]
fn times_are_dates_or_epochs_of_any_unit() {
    let first = 1_600_000_000_000_000;
    let expected = [(first, 1.0), (first + 250_000, 2.0)];
    for (a, b) in [
        ("2020-09-13T12:26:40Z", "2020-09-13T12:26:40.250Z"),
        ("2020-09-13 12:26:40", "2020-09-13 12:26:40.25"),
        (
            "2020-09-13T14:26:40.0+02:00",
            "2020-09-13T14:26:40.25+02:00",
        ),
        (
            "2020-09-13 12:26:40+00:00",
            "2020-09-13 12:26:40.250000+00:00",
        ),
        ("2020-09-13 12:26:40 UTC", "2020-09-13 12:26:40.25 UTC"),
        ("1600000000", "1600000000.25"),
        ("1600000000000", "1600000000250"),
        ("1600000000000000", "1600000000250000"),
        ("1600000000000000000", "1600000000250000000"),
    ] {
        let table = format!("timestamp,wheel_speed_mps\n{a},1\n{b},2\n");
        assert_eq!(speeds(&table), expected, "{a}");
    }
    for (unit, step) in [
        ("ms", "250"),
        ("us", "250000"),
        ("ns", "250000000"),
        ("s", "0.25"),
    ] {
        let table = format!("time [{unit}],wheel_speed_mps\n0,1\n{step},2\n");
        assert_eq!(speeds(&table), [(0, 1.0), (250_000, 2.0)], "{unit}");
    }
    // Small numbers without a unit may be anything.
    let unknown = "time,wheel_speed_mps\n0,1\n250,2\n";
    let message = read(unknown.as_bytes()).unwrap_err();
    assert!(message.contains("time [ms]"), "{message}");
    // No day of the year, and no time of the day.
    let no_date = "timestamp,wheel_speed_mps\n2020-02-30T00:00:00Z,1\n";
    assert!(read(no_date.as_bytes()).is_err());
}

#[test]
fn words_and_places_are_read() {
    let table = "time_s,brake,wheel_speed_mps,lat,lon\n\
                 0,TRUE,NA,47.5,8.5\n0.1,false,null,-,n/a\n0.2,0,3,47.5,8.5\n";
    let rows = read(table.as_bytes()).unwrap();
    let brake = |value| (Signal::BrakeSwitch, Value::Real(value));
    let latitude = (Signal::Latitude, Value::DegreesE7(475_000_000));
    let longitude = (Signal::Longitude, Value::DegreesE7(85_000_000));
    assert_eq!(rows[0].1, [brake(1.0), latitude, longitude]);
    assert_eq!(rows[1].1, [brake(0.0)]);
    assert_eq!(rows[2].1.len(), 4);
    // A speed is not true.
    let wrong = "time_s,wheel_speed_mps\n0,TRUE\n";
    assert!(
        read(wrong.as_bytes())
            .unwrap_err()
            .contains("wheel_speed_mps is `TRUE`")
    );
}

#[test]
fn columns_are_mapped_by_a_file() {
    let table = "t,v,other\n0,36,1\n250,72,1\n";
    let mapping = "[columns.time_s]\ncolumn = \"t\"\nunit = \"ms\"\n\
                   [columns.wheel_speed_mps]\ncolumn = \"v\"\n";
    let expected = Ok(vec![(0, 10.0), (250_000, 20.0)]);
    let with = |lines: &str| with_columns(&format!("{mapping}{lines}"), table);
    assert_eq!(with("unit = \"km/h\"\n"), expected);
    assert_eq!(with("scale = 0.27777777777777777\n"), expected);
    assert_eq!(with(""), Ok(vec![(0, 36.0), (250_000, 72.0)]));
    for (lines, expected) in [
        (
            "unit = \"Nm\"\n",
            "columns.toml:4: columns.wheel_speed_mps.unit is `Nm`",
        ),
        ("unit = \"km/h\"\nscale = 2\n", "either unit, or scale"),
        ("scale = 0\n", "a scale other than 0"),
        ("factor = 1\n", "unknown field `factor`"),
        (
            "[columns.altitude]\ncolumn = \"other\"\n",
            "such as `altitude_m`",
        ),
        (
            "[columns.altitude_m]\ncolumn = \"othr\"\n",
            "one such as `other`",
        ),
    ] {
        let message = with(lines).unwrap_err();
        assert!(message.contains(expected), "{lines}: {message}");
    }
    // What is mapped comes before what the name says.
    let table = "time_s,wheel_speed_mps,true_speed\n0,1,2\n";
    let mapping = "[columns.wheel_speed_mps]\ncolumn = \"true_speed\"\n";
    assert_eq!(with_columns(mapping, table), Ok(vec![(0, 2.0)]));
}

#[test]
fn the_proposal_of_inspect_is_a_mapping() {
    let folder = folder();
    let mut table =
        "Log time;Vehicle speed [km/h];GPS Speed [km/h];Engine RPM [rpm];Altitude over sea [ft];\
                     Actual engine percent torque [%];Speed limit [km/h];Note\n"
            .to_owned();
    for k in 0..100 {
        table += &format!(
            "2026-11-22 10:00:{:02},{}00;{};{};1200,5;{};30;50;x\n",
            k / 10,
            k % 10,
            40 + k % 20,
            41 + k % 20,
            300 + k
        );
    }
    std::fs::write(folder.path().join("t.csv"), &table).unwrap();
    let run = |line: &str| {
        let words: Vec<&str> = line.split(' ').collect();
        roadgrade(folder.path(), &words)
    };
    run("inspect t.csv").success();
    run("estimate t.csv").failure();
    run("inspect t.csv --out columns.toml").success();
    let text = std::fs::read_to_string(folder.path().join("columns.toml")).unwrap();
    for (signal, column) in [
        ("time_s", "Log time"),
        ("wheel_speed_mps", "Vehicle speed [km/h]"),
        ("gnss_speed_mps", "GPS Speed [km/h]"),
        ("engine_speed_rpm", "Engine RPM [rpm]"),
        ("altitude_m", "Altitude over sea [ft]"),
        ("engine_torque_percent", "Actual engine percent torque [%]"),
    ] {
        let table = format!("[columns.{signal}]\ncolumn = \"{column}\"\n");
        assert!(text.contains(&table), "{signal}:\n{text}");
    }
    assert!(!text.contains("limit"), "{text}");
    let seen = run("inspect --json t.csv --columns columns.toml").success();
    let json: serde_json::Value = serde_json::from_slice(&seen.get_output().stdout).unwrap();
    let signals = json["signals"].as_array().unwrap();
    let speed = signals
        .iter()
        .find(|signal| signal["signal"] == "wheel_speed_mps")
        .unwrap();
    assert_eq!(speed["available"], 100);
    assert!((speed["min"].as_f64().unwrap() - 11.111).abs() < 0.01);
    assert_eq!(json["start_s"], 1_795_341_600.0);
}
