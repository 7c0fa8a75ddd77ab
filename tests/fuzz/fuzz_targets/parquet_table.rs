#![no_main]

use fuzz_targets::targets::logs::parquet_table;
use fuzz_targets::{MOST_BYTES, bounded};

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| bounded(MOST_BYTES, parquet_table, bytes));
