#![no_main]

use fuzz_targets::targets::logs::n2k_text;
use fuzz_targets::{MOST_BYTES, bounded};

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| bounded(MOST_BYTES, n2k_text, bytes));
