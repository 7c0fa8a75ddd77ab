//! The third-party library of the pages is unchanged, and its licence goes with it.

use sha2::{Digest, Sha256};
use std::fmt::Write;
use std::fs;
use std::path::Path;

/// Files of `uplot` 1.6.32 as its npm package has them.
const UPLOT: [(&str, &str); 3] = [
    (
        "LICENSE",
        "8f989229699b4fe2f1a0432d0e9edc338a8a911e250e2d1b01ecd770a5f5b1bd",
    ),
    (
        "uPlot.iife.min.js",
        "19c8d4c6ad88929a79f4ae49d6f7161566dfd0ba3d15cc495e974f787eb78f1f",
    ),
    (
        "uPlot.min.css",
        "df630c6a8d6f8eeaff264b50f73ce5b114f646ffd9a0bb74f049b0a00135fa04",
    ),
];

#[test]
fn the_plotting_library_is_unchanged() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("src/report/assets/uplot");
    for (name, expected) in UPLOT {
        let bytes = fs::read(folder.join(name)).expect("a file");
        let sum = Sha256::digest(&bytes)
            .iter()
            .fold(String::new(), |mut sum, byte| {
                write!(sum, "{byte:02x}").expect("memory");
                sum
            });
        assert_eq!(sum, expected, "{name}");
    }
    let version = fs::read_to_string(folder.join("VERSION.txt")).expect("text");
    let script = fs::read_to_string(folder.join("uPlot.iife.min.js")).expect("text");
    assert!(version.contains("uPlot 1.6.32") && script.contains("(v1.6.32)"));
    let files = fs::read_dir(&folder).expect("a folder").count();
    assert_eq!(files, UPLOT.len() + 1, "each file has its sum");
}
