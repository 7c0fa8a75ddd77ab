#![no_main]

use fuzz_targets::targets::persistent_state::persistent_state;
use fuzz_targets::{MOST_BYTES, bounded};

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| bounded(MOST_BYTES, persistent_state, bytes));
