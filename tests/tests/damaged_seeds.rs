//! The fuzz targets without a fuzzer: each seed as it is, and damaged at random. `tests/run fuzz` steers
//! the same targets by coverage.

use fuzz_targets::targets::{ALL, Target};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use std::path::{Path, PathBuf};
use std::thread::panicking;
use std::{env, fs};
use test_kit::damage::damage_bytes;

/// Damaged inputs of a target.
const INPUTS: u64 = 1_000;
/// Those of the target `estimator`: an input may be minutes of driving.
const DRIVES: u64 = 40;

/// An input. If its check panics, it is kept as a file.
struct Input {
    target: &'static str,
    bytes: Vec<u8>,
}

impl Drop for Input {
    fn drop(&mut self) {
        if panicking() {
            let path = env::temp_dir().join(format!("failing_input_of_{}", self.target));
            fs::write(&path, &self.bytes).expect("the failing input can be written");
            eprintln!("the input that failed: {}", path.display());
        }
    }
}

#[test]
fn targets_take_their_seeds_and_damaged_ones() {
    for (target, check) in ALL {
        let seeds = seeds(target);
        assert!(!seeds.is_empty(), "no seeds of {target}");
        for bytes in &seeds {
            run((target, check), bytes.clone());
        }
        let count = if target == "estimator" {
            DRIVES
        } else {
            INPUTS
        };
        for number in 0..count {
            let mut random = ChaCha8Rng::seed_from_u64(number);
            let mut bytes = seeds[random.random_range(0..seeds.len())].clone();
            for _ in 0..random.random_range(1..4) {
                damage_bytes(&mut bytes, &mut random);
            }
            run((target, check), bytes);
        }
    }
}

#[test]
fn each_target_has_a_program_for_the_fuzzer() {
    let folder = fuzz_folder().join("fuzz_targets");
    let mut programs: Vec<PathBuf> = files(&folder);
    programs.sort();
    let expected = ALL.map(|(target, _)| folder.join(target).with_extension("rs"));
    assert_eq!(programs, expected);
}

fn run((target, check): Target, bytes: Vec<u8>) {
    let input = Input { target, bytes };
    check(&input.bytes);
}

fn seeds(target: &str) -> Vec<Vec<u8>> {
    let mut paths = files(&fuzz_folder().join("corpus").join(target));
    // In the same order on every file system.
    paths.sort();
    paths.iter().map(|path| fs::read(path).unwrap()).collect()
}

fn files(folder: &Path) -> Vec<PathBuf> {
    let entries = fs::read_dir(folder).unwrap_or_else(|error| panic!("{folder:?}: {error}"));
    entries.map(|entry| entry.unwrap().path()).collect()
}

fn fuzz_folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("fuzz")
}
