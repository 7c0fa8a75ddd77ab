//! The bytes of a log, unpacked: plain, gzip (RFC 1952) or Zstandard (RFC 8878).

use super::packed_bytes::{ZSTD_MAGIC, is_skippable};
use super::packed_members::Members;
use super::packing::{Packing, RawState};
use crate::files::marks::GZIP_MAGIC;
use std::io::{self, Cursor, ErrorKind, Read};

/// Counts the packed bytes.
struct Counting<R> {
    inner: R,
    state: RawState,
}

impl<R: Read> Read for Counting<R> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let count = match self.inner.read(buffer) {
            Err(e) if e.kind() != ErrorKind::Interrupted => {
                self.state.set_failed();
                return Err(e);
            }
            other => other?,
        };
        self.state.add(count as u64);
        if count == 0 && !buffer.is_empty() {
            self.state.set_over();
        }
        Ok(count)
    }
}

/// Unpacks bytes. The first ones, not a name, decide how they are packed.
pub(super) fn unpacked(
    mut packed: impl Read + Send + 'static,
) -> io::Result<(Box<dyn Read + Send>, Packing, RawState)> {
    let mut head = Vec::new();
    packed
        .by_ref()
        .take(ZSTD_MAGIC.len() as u64)
        .read_to_end(&mut head)?;
    let packing = if head.starts_with(GZIP_MAGIC) {
        Packing::Gzip
    } else if head == ZSTD_MAGIC || is_skippable(&head) {
        Packing::Zstd
    } else {
        Packing::Plain
    };
    let state = RawState::default();
    // Chained, not rewound: a pipe cannot be rewound.
    let raw = Counting {
        inner: Cursor::new(head).chain(packed),
        state: state.clone(),
    };
    let content: Box<dyn Read + Send> = match packing {
        Packing::Plain => Box::new(raw),
        packing => Box::new(Members::new(raw, packing, state.clone())),
    };
    Ok((content, packing, state))
}
