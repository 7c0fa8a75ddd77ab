//! Packed logs.

use flate2::{Compression, write::GzEncoder};
use std::io::Write;

/// Returns the content as a gzip file.
pub fn gzip(content: &[u8]) -> Vec<u8> {
    let mut encoder = GzEncoder::new(Vec::new(), Compression::default());
    encoder.write_all(content).expect("memory");
    encoder.finish().expect("memory")
}
