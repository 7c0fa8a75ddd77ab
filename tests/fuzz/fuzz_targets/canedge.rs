#![no_main]

use fuzz_targets::targets::logs::canedge;
use fuzz_targets::{MOST_BYTES, bounded};

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| bounded(MOST_BYTES, canedge, bytes));
