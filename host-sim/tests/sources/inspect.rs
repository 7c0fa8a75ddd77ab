//! `roadgrade inspect` as a user calls it.

use assert_cmd::Command;
use embedded_can::Frame;
use estimator_core::signal::encode;
use estimator_core::{Instant, Signal, Value};
use host_sim::source::can_frame::{CanFrame, TimedFrame};
use host_sim::source::candump_writer::write_frame;
use predicates::prelude::*;
use serde_json::{Value as Json, json};
use std::path::{Path, PathBuf};
use tempfile::TempDir;
use test_kit::command::{folder, program};

fn inspect(log: &Path) -> Command {
    let mut command = program();
    command.arg("inspect").arg(log);
    command
}

fn inspect_json(log: &Path) -> Json {
    let output = inspect(log).arg("--json").assert().success();
    serde_json::from_slice(&output.get_output().stdout).expect("JSON")
}

/// Returns the first entry of `list` whose `key` is `value`.
fn entry<'a>(list: &'a Json, key: &str, value: impl Into<Json>) -> &'a Json {
    let value = value.into();
    let mut entries = list.as_array().expect("a list").iter();
    entries
        .find(|entry| entry[key] == value)
        .unwrap_or_else(|| panic!("no {key} {value} in {list:#}"))
}

fn file(folder: &TempDir, name: &str, content: impl AsRef<[u8]>) -> PathBuf {
    let path = folder.path().join(name);
    std::fs::write(&path, content).expect("a temporary file");
    path
}

/// Returns the log of ten seconds of a small bus: EEC1 at 50 Hz, CCVS1 at 10 Hz from two senders,
/// one of which has no speed, a fast packet with a fix each second, and other messages.
fn small_bus() -> Vec<u8> {
    let mut text = Vec::new();
    for k in 0..=500_u64 {
        let time = Instant::from_micros(5_000_000 + k * 20_000);
        let mut send = |id: u32, data: &[u8]| {
            let frame = CanFrame::extended(id, data).expect("a frame");
            write_frame(&mut text, &TimedFrame { time, frame }, "can0").expect("memory");
        };
        let mut payload = [0; 43];
        let torque = if k < 100 {
            Value::NotAvailable
        } else {
            Value::Real(40.0)
        };
        encode(61_444, &mut payload, |signal| match signal {
            Signal::EngineTorque if k == 100 => Value::Error,
            Signal::EngineTorque => torque,
            Signal::EngineSpeed => Value::Real(1_000.0 + k as f32),
            _ => Value::NotAvailable,
        });
        send(0x0CF0_0400, &payload[..8]);
        if k % 5 == 0 {
            for (source, speed) in [(0, Value::Real(20.0)), (0x11, Value::NotAvailable)] {
                encode(65_265, &mut payload, |signal| match signal {
                    Signal::WheelSpeed => speed,
                    Signal::BrakeSwitch => Value::Real(0.0),
                    _ => Value::NotAvailable,
                });
                send(0x18FE_F100 | source, &payload[..8]);
            }
        }
        if k % 50 == 0 {
            encode(129_029, &mut payload, |signal| match signal {
                Signal::Latitude => Value::DegreesE7(473_700_000),
                Signal::Longitude => Value::DegreesE7(85_400_000),
                Signal::Altitude => Value::Real(432.5),
                _ => Value::NotAvailable,
            });
            let id = 0x0DF8_0542;
            for (number, frame) in CanFrame::carrying(id, 0, &payload).enumerate() {
                // The last packet has a hole.
                if k < 500 || number != 3 {
                    send(id, frame.data());
                }
            }
        }
        if k < 40 {
            send(0x18FF_0000 | (k as u32) << 8, &[1, 2, 3]);
        }
    }
    text
}

#[test]
fn messages_have_their_names_senders_and_rates() {
    let folder = TempDir::new().expect("a temporary folder");
    let bus = inspect_json(&file(&folder, "bus.log", small_bus()));
    assert_eq!(bus["kind"], "candump log");
    assert_eq!(bus["start_s"], 5.0);
    assert_eq!(bus["duration_s"], 10.0);
    let eec1 = entry(&bus["messages"], "pgn", 61_444);
    assert_eq!(
        *eec1,
        json!({ "pgn": 61_444, "name": "EEC1", "decoded": true, "sources": [0], "frames": 501,
                "rate_hz": 50.0, "unusable": 0 })
    );
    let ccvs = entry(&bus["messages"], "pgn", 65_265);
    assert_eq!(
        (&ccvs["sources"], &ccvs["frames"]),
        (&json!([0, 17]), &json!(202))
    );
    let gnss = entry(&bus["messages"], "pgn", 129_029);
    // After the hole every frame of the packet is useless.
    assert_eq!(
        (&gnss["frames"], &gnss["unusable"]),
        (&json!(76), &json!(3))
    );
}

#[test]
fn signals_have_their_shares_and_ranges_by_sender() {
    let folder = TempDir::new().expect("a temporary folder");
    let bus = inspect_json(&file(&folder, "bus.log", small_bus()));
    assert_eq!(
        *entry(&bus["signals"], "signal", "engine_torque_percent"),
        json!({ "signal": "engine_torque_percent", "pgn": 61_444, "source": 0, "count": 501,
                "available": 400, "not_available": 100, "errors": 1,
                "min": 40.0, "mean": 40.0, "max": 40.0 })
    );
    let rpm = entry(&bus["signals"], "signal", "engine_speed_rpm");
    assert_eq!(
        (&rpm["min"], &rpm["mean"], &rpm["max"]),
        (&json!(1000.0), &json!(1250.0), &json!(1500.0))
    );
    let speeds: Vec<_> = bus["signals"]
        .as_array()
        .expect("a list")
        .iter()
        .filter(|signal| signal["signal"] == "wheel_speed_mps")
        .map(|signal| {
            (
                &signal["source"],
                &signal["available"],
                &signal["not_available"],
            )
        })
        .collect();
    assert_eq!(
        speeds,
        [
            (&json!(0), &json!(101), &json!(0)),
            (&json!(17), &json!(0), &json!(101))
        ]
    );
    let latitude = entry(&bus["signals"], "signal", "latitude_deg");
    assert_eq!(
        (&latitude["count"], &latitude["mean"]),
        (&json!(10), &json!(47.37))
    );
}

#[test]
fn missing_signals_are_reported_with_their_consequence() {
    let folder = TempDir::new().expect("a temporary folder");
    let bus = file(&folder, "bus.log", small_bus());
    let needs = &inspect_json(&bus)["needs"];
    for (what, importance, presence) in [
        ("speed", "needed", "present"),
        ("engine torque or traction force", "needed", "present"),
        ("GNSS altitude", "needed", "present"),
        ("GNSS position", "optional", "present"),
        ("engine friction torque", "optional", "missing"),
        // Engine speed and wheel speed replace it.
        ("gear or gear ratio", "optional", "missing"),
        ("gear shift flags", "optional", "missing"),
        ("brake flags", "optional", "present"),
        ("GNSS quality", "optional", "never_available"),
    ] {
        let need = entry(needs, "what", what);
        assert_eq!(
            (&need["importance"], &need["presence"]),
            (&json!(importance), &json!(presence)),
            "{what}"
        );
    }
    inspect(&bus)
        .assert()
        .success()
        .stdout(predicate::str::contains(
            "Nothing that an estimate needs is missing.",
        ));

    let bare = file(
        &folder,
        "bare.log",
        "(1.0) can0 123#01\n(2.0) can0 124#01\n",
    );
    inspect(&bare).assert().success().stdout(
        predicate::str::contains("No parameter group")
            .and(predicate::str::contains(
                "No signal that the estimator reads",
            ))
            .and(predicate::str::contains(
                "Needed and missing: speed, engine torque or traction force, GNSS altitude, \
                 gear or gear ratio.",
            )),
    );
    // The table on a terminal breaks its lines, so the words are searched in the JSON.
    let needs = inspect_json(&bare)["needs"].to_string();
    assert!(needs.contains("2 identifiers of 11 bits"), "{needs}");
}

#[test]
fn only_the_most_frequent_unknown_messages_are_listed_unless_all_are_wanted() {
    let folder = TempDir::new().expect("a temporary folder");
    let bus = file(&folder, "bus.log", small_bus());
    let rows = |arguments: &[&str]| {
        let assert = inspect(&bus).args(arguments).assert().success();
        let text = String::from_utf8(assert.get_output().stdout.clone()).expect("text");
        let rows = text.lines().filter(|line| line.contains(" PropB ")).count();
        (
            rows,
            text.contains("and 25 more parameter groups with 25 frames"),
        )
    };
    assert_eq!(rows(&[]), (15, true));
    assert_eq!(rows(&["--all"]), (40, false));
}

#[test]
fn frames_that_are_left_out_are_counted() {
    let folder = TempDir::new().expect("a temporary folder");
    let log = file(
        &folder,
        "odd.log",
        "(1.0) can0 123##500\n(1.1) can0 20000004#00\n(1.2) can0 0CF00400#R\n\
         (1.3) can0 0CF00400#01\n(1.4) can0 1CECFF21#20270006FFE3FE00\n",
    );
    inspect(&log).assert().success().stdout(
        predicate::str::contains("3 frames in 0.200 s, from 1.200000 s")
            .and(predicate::str::contains("1 remote frames"))
            .and(predicate::str::contains("1 CAN FD frames, left out"))
            .and(predicate::str::contains("1 bus errors, left out"))
            .and(predicate::str::contains(
                "2 frames of decoded messages unusable",
            )),
    );
    let odd = inspect_json(&log);
    assert_eq!(
        *entry(&odd["transported"], "pgn", 65_251),
        json!({ "pgn": 65_251, "name": "EC1", "announced": 1, "length_bytes": 39 })
    );
}

#[test]
fn signal_tables_are_inspected_too() {
    let folder = TempDir::new().expect("a temporary folder");
    let table = file(
        &folder,
        "table.csv",
        "time_s,wheel_speed_mps,traction_force_n,altitude_m\n10,0,100,\n11,0.05,,400\n12,0,300,\n",
    );
    inspect(&table).assert().success().stdout(
        predicate::str::contains("signal table, 3 rows in 2.000 s, from 10.000000 s").and(
            predicate::str::contains("the vehicle never moves in this log"),
        ),
    );
    let json = inspect_json(&table);
    assert_eq!(
        *entry(&json["signals"], "signal", "traction_force_n"),
        json!({ "signal": "traction_force_n", "pgn": null, "source": null, "count": 3,
                "available": 2, "not_available": 1, "errors": 0,
                "min": 100.0, "mean": 200.0, "max": 300.0 })
    );
    // A traction force needs no gear.
    let gear = entry(&json["needs"], "what", "gear or gear ratio");
    assert_eq!(gear["importance"], "optional");
    // A latitude alone is no position.
    let half = file(&folder, "half.csv", "time_s,latitude_deg\n0,47.1\n");
    let position = &inspect_json(&half)["needs"];
    assert_ne!(
        entry(position, "what", "GNSS position")["presence"],
        "present"
    );
}

#[test]
fn bad_logs_end_with_a_message_and_nothing_on_stdout() {
    let folder = TempDir::new().expect("a temporary folder");
    for (name, content, message) in [
        (
            "empty.log",
            &b""[..],
            "empty.log: the file is empty; expected",
        ),
        (
            "binary.log",
            b"\x00\x01\x02\n",
            "binary.log: unknown format, begins with `",
        ),
        (
            "text.log",
            b"To be or not to be\n",
            "text.log: unknown format, begins with `To be or not",
        ),
        ("cut.log", b"(1.0) can0 12", "cut.log:1: no CAN identifier"),
        (
            "back.log",
            b"(2.0) can0 123#01\n(1.0) can0 123#01\n",
            "back.log:2: time runs backwards",
        ),
        (
            "bad.csv",
            b"time_s,gear\n0,x\n",
            "bad.csv:2: gear is `x`; expected a finite number",
        ),
        ("empty.csv", b"", "empty.csv: the file is empty; expected"),
    ] {
        inspect(&file(&folder, name, content))
            .assert()
            .code(1)
            .stdout("")
            .stderr(predicate::str::contains(message));
    }
    inspect(Path::new("no/such.log"))
        .assert()
        .code(1)
        .stderr(predicate::str::contains("no/such.log"));
    program().arg("inspect").assert().code(2);
}

#[test]
fn a_real_truck_s_bus() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shared/data");
    let log = root.join("css_truck_idle/truck_idle.log");
    if !log.exists() {
        eprintln!("SKIPPED: no measured data at ../shared/data/css_truck_idle");
        return;
    }
    let bus = inspect_json(&log);
    let eec1 = entry(&bus["messages"], "pgn", 61_444);
    assert_eq!(
        (&eec1["name"], &eec1["frames"]),
        (&json!("EEC1"), &json!(12_719))
    );
    let rate = eec1["rate_hz"].as_f64().expect("a rate");
    assert!((rate - 100.0).abs() < 0.1, "{rate}");
    for (signal, low, high) in [
        ("engine_torque_percent", 1.0, 30.0),
        ("friction_torque_percent", 1.0, 20.0),
        ("engine_speed_rpm", 500.0, 900.0),
        ("wheel_speed_mps", 0.0, 0.1),
        ("ambient_celsius", -30.0, 50.0),
        ("air_pressure_pa", 80_000.0, 105_000.0),
    ] {
        let range = entry(&bus["signals"], "signal", signal);
        for figure in ["min", "mean", "max"] {
            let value = range[figure].as_f64().expect("a figure");
            assert!((low..=high).contains(&value), "{signal} {figure} {value}");
        }
    }
    // The transport protocol carries the engine configuration (EC1): 2,386 Nm, every 5 s.
    for (signal, value) in [
        ("reference_torque_nm", 2_386.0),
        ("engine_inertia_kgm2", 3.824),
    ] {
        let range = entry(&bus["signals"], "signal", signal);
        assert_eq!(
            (&range["pgn"], &range["source"]),
            (&json!(65_251), &json!(0))
        );
        assert_eq!(
            (&range["count"], &range["available"]),
            (&json!(25), &json!(25))
        );
        for figure in ["min", "max"] {
            let found = range[figure].as_f64().expect("a figure");
            assert!((found - value).abs() < 1e-6, "{signal} {figure} {found}");
        }
    }
    assert_eq!(entry(&bus["messages"], "name", "TP.CM")["pgn"], 60_416);
    assert_eq!(entry(&bus["messages"], "name", "TP.DT")["pgn"], 60_160);
    assert_eq!(
        entry(&bus["transported"], "pgn", 65_251)["length_bytes"],
        39
    );
    // The GNSS module's identifiers.
    assert_eq!(bus["standard_ids"].as_array().map(Vec::len), Some(9));
    for what in ["GNSS altitude", "GNSS position", "gear or gear ratio"] {
        assert_eq!(
            entry(&bus["needs"], "what", what)["presence"],
            "missing",
            "{what}"
        );
    }
    inspect(&log).assert().success().stdout(
        predicate::str::contains("Needed and missing: GNSS altitude.")
            .and(predicate::str::contains("TP.CM"))
            .and(predicate::str::contains("11-bit identifiers"))
            .and(predicate::str::contains("the vehicle never moves")),
    );
}

#[test]
fn a_few_values_that_cannot_be_do_not_hide_a_signal() {
    let folder = folder();
    let at = folder.path();
    let dbc =
        "VERSION \"\"\nBU_:\nBO_ 4 gnss: 8 X\n SG_ Altitude : 0|18@1+ (0.1,-6000) [0|0] \"m\" X\n";
    std::fs::write(at.join("gnss.dbc"), dbc).unwrap();
    // A receiver without a fix, for `share` of the time.
    let log = |share: f64| -> String {
        let line = |k: u32| {
            let height = if f64::from(k) < 400.0 * share {
                6000
            } else {
                61_000 + k % 100
            };
            let [a, b, c, _] = height.to_le_bytes();
            let s = f64::from(k) * 0.1;
            format!("({s:.6}) can0 004#{a:02X}{b:02X}{c:02X}0000000000\n")
        };
        (0..400).map(line).collect()
    };
    for (share, is_proposed) in [(0.0, true), (0.02, true), (0.4, false)] {
        std::fs::write(at.join("drive.log"), log(share)).unwrap();
        let run = program()
            .current_dir(at)
            .args(["inspect", "--dbc", "gnss.dbc", "drive.log"])
            .assert();
        let told = String::from_utf8(run.get_output().stdout.clone()).unwrap();
        assert_eq!(
            told.contains("[signals.altitude_m]"),
            is_proposed,
            "{share}: {told}"
        );
        let has_others = told.contains("a few are beyond what it can be");
        assert_eq!(has_others, share > 0.0 && is_proposed, "{share}: {told}");
    }
}
