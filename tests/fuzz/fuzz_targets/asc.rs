//! Vector ASC logs: frames in the order of time, or an error that names the file.

#![no_main]

use fuzz_targets::check_log;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| check_log(b"base hex", bytes));
