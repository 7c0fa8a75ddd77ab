//! What arbitrary input must not break. Each target is a function of bytes: libFuzzer calls it by the
//! programs in `fuzz_targets`, and the test `damaged_seeds` of the workspace calls it without.

pub mod bus;
pub mod sessions;
pub mod targets;

use estimator_core::VehicleParameters;
use peak_alloc::PeakAlloc;
use std::io::Write;
use std::path::Path;
use test_kit::truck_with;

/// Bytes that no input may take, besides those that are taken before.
pub const MOST_BYTES: usize = 64_000_000;

#[global_allocator]
static MEMORY: PeakAlloc = PeakAlloc;

/// Gives an input to a target.
///
/// # Panics
/// Panics if the target does, or if it takes more bytes of memory at any time.
pub fn bounded(most_bytes: usize, target: fn(&[u8]), bytes: &[u8]) {
    let before = MEMORY.current_usage();
    MEMORY.reset_peak_usage();
    target(bytes);
    let taken = MEMORY.peak_usage().saturating_sub(before);
    assert!(
        taken <= most_bytes,
        "{taken} bytes of memory; at most {most_bytes}"
    );
}

/// Returns a truck of two gears. Its fingerprint is in the corpus of `persistent_state`.
#[must_use]
pub fn truck() -> VehicleParameters {
    VehicleParameters {
        mass_kg: 30_000.0,
        rolling_resistance: 0.006,
        ..truck_with(2_500.0, &[1.26, 1.0])
    }
}

/// Writes `bytes` to a file and calls `read` with its path.
pub fn as_file(suffix: &str, bytes: &[u8], read: impl FnOnce(&Path)) {
    let mut file = tempfile::Builder::new()
        .suffix(suffix)
        .tempfile()
        .expect("a temporary file");
    file.write_all(bytes).expect("the file can be written");
    read(file.path());
}
