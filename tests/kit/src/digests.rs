//! Digests of what a drive gave, committed beside the test that drives it.

use std::fmt::Write as _;

/// A digest of bytes and numbers (FNV-1a).
pub struct Digest(u64);

impl Default for Digest {
    fn default() -> Self {
        Self(0xcbf2_9ce4_8422_2325)
    }
}

impl Digest {
    pub fn add(&mut self, bytes: &[u8]) {
        for byte in bytes {
            self.0 = (self.0 ^ u64::from(*byte)).wrapping_mul(0x0100_0000_01b3);
        }
    }

    /// Adds a value as it is formatted for a developer: numbers to their last bit.
    pub fn debug(&mut self, value: &impl std::fmt::Debug) {
        self.add(format!("{value:?}").as_bytes());
    }

    pub fn number(&mut self, number: f32) {
        self.add(&number.to_bits().to_le_bytes());
    }

    pub const fn value(&self) -> u64 {
        self.0
    }
}

/// Compares what drives gave, a line each, with what is committed in a file. With the variable
/// `CHANGE_INDICATOR=write`, writes it there. Fails with the lines that differ.
pub fn check_digests(found: &[String], committed: &str, path: &str) {
    if std::env::var_os("CHANGE_INDICATOR").is_some_and(|what| what == "write") {
        std::fs::write(path, found.join("\n") + "\n").expect("a file of digests");
        return;
    }
    // Without the feature `fixed`, the last one is not driven.
    let committed: Vec<&str> = committed.lines().take(found.len()).collect();
    assert_eq!(found.len(), committed.len(), "drives in {path}");
    let mut changes = String::new();
    for (found, committed) in found.iter().zip(&committed) {
        if found != committed {
            writeln!(changes, "was {committed}\nis  {found}").expect("a string");
        }
    }
    assert!(changes.is_empty(), "{changes}");
}
