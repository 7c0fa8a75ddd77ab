#![no_main]

use fuzz_targets::targets::logs::savvy_can;
use fuzz_targets::{MOST_BYTES, bounded};

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| bounded(MOST_BYTES, savvy_can, bytes));
