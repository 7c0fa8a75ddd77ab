//! `roadgrade import`: tables of measured data sets, and unusable files.

mod bad_input;
mod i3;
mod measured;
mod mission_maker;
mod passes;

use assert_cmd::Command;
use std::path::{Path, PathBuf};
use test_kit::command::program;
use test_kit::tables::columns;

/// Returns the path of measured data; `None` if they are absent.
fn shared(name: &str) -> Option<PathBuf> {
    let data = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shared/data");
    let path = data.join(name);
    if !path.exists() {
        eprintln!("SKIPPED: no measured data at ../shared/data/{name}");
        return None;
    }
    Some(path)
}

fn import(file: &Path, out: &Path) -> Command {
    let mut command = program();
    command.args(["import", "ztbus"]).arg(file);
    command.arg("--out").arg(out);
    command
}

/// Checks all pass tables: numbers only, increasing time from 0 on, fixes, and the stated length.
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
        let driven_m: f64 = time_s
            .windows(2)
            .zip(speed_mps.windows(2))
            .map(|(t, v)| 0.5 * (v[0] + v[1]) * (t[1] - t[0]))
            .sum();
        let length_m = pass["length_m"].as_f64().unwrap();
        assert!((driven_m - length_m).abs() < 1.0, "{driven_m} {length_m}");
    }
}
