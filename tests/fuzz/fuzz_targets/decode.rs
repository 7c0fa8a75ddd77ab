#![no_main]

use fuzz_targets::targets::decode::decode;
use fuzz_targets::{MOST_BYTES, bounded};

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| bounded(MOST_BYTES, decode, bytes));
