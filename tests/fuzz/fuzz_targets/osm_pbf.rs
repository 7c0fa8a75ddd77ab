#![no_main]

use fuzz_targets::bounded;
use fuzz_targets::targets::osm_pbf::{MOST_BYTES, osm_pbf};

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| bounded(MOST_BYTES, osm_pbf, bytes));
