#![no_main]

use fuzz_targets::targets::vehicle_toml::vehicle_toml;
use fuzz_targets::{MOST_BYTES, bounded};

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| bounded(MOST_BYTES, vehicle_toml, bytes));
