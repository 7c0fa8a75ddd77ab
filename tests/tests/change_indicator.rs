//! No behaviour changes without a change in `tests/change_indicator`.

use cross_tests::change_indicator::{changes, committed_folder, indicate};
use std::collections::BTreeSet;
use std::ffi::OsStr;
use std::fs;

const ACCEPT: &str =
    "to accept: cargo run -p cross-tests --release --example change_indicator -- --write";

#[test]
fn every_input_gives_what_is_committed() {
    let indicated = indicate().unwrap();
    for input in &indicated.absent {
        eprintln!("SKIPPED: the change indicator of {input}, which is absent");
    }
    let changes: String = indicated.indications.iter().map(changes).collect();
    assert!(changes.is_empty(), "{changes}\n{ACCEPT}");
    // Without this check the file of a removed input would remain and be compared with nothing.
    let given: BTreeSet<&str> = indicated.indications.iter().map(|of| &*of.input).collect();
    for file in fs::read_dir(committed_folder()).unwrap() {
        let path = file.unwrap().path();
        let input = path.file_stem().and_then(OsStr::to_str).unwrap();
        let is_absent = !indicated.absent.is_empty() && is_recorded(input);
        assert!(
            given.contains(input) || is_absent,
            "{}: no such input",
            path.display()
        );
    }
}

fn is_recorded(input: &str) -> bool {
    input.starts_with("ztbus") || input == "truck_idle"
}
