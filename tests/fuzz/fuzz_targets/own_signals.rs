#![no_main]

use fuzz_targets::targets::own_signals::own_signals;
use fuzz_targets::{MOST_BYTES, bounded};

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| bounded(MOST_BYTES, own_signals, bytes));
