//! The bytes of a log, unpacked: plain, gzip (RFC 1952) or Zstandard (RFC 8878).

use flate2::read::MultiGzDecoder;
use ruzstd::decoding::{FrameDecoder, StreamingDecoder};
use std::io::{self, BufRead, BufReader, Cursor, ErrorKind, Read};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

/// First bytes of a gzip file.
const GZIP_MAGIC: &[u8] = &[0x1f, 0x8b];
/// First bytes of a Zstandard frame.
const ZSTD_MAGIC: &[u8] = &[0x28, 0xb5, 0x2f, 0xfd];
/// Largest window of Zstandard, bytes: more than its level 19 uses; only `--long` may use more.
const MOST_WINDOW_BYTES: u64 = 32 << 20;

/// How a log is packed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Packing {
    Plain,
    Gzip,
    Zstd,
}

impl Packing {
    /// Returns its name for messages.
    pub(super) const fn name(self) -> &'static str {
        match self {
            Self::Plain => "file",
            Self::Gzip => "gzip",
            Self::Zstd => "zstd",
        }
    }
}

/// What is known of the packed bytes.
#[derive(Clone, Default)]
pub(super) struct RawState {
    bytes: Arc<AtomicU64>,
    is_over: Arc<AtomicBool>,
}

impl RawState {
    /// Returns the number of packed bytes read.
    pub(super) fn bytes(&self) -> u64 {
        self.bytes.load(Ordering::Relaxed)
    }

    /// Counts bytes that were read in another way.
    pub(super) fn add(&self, bytes: u64) {
        self.bytes.fetch_add(bytes, Ordering::Relaxed);
    }

    /// Returns true if all packed bytes were read.
    pub(super) fn is_over(&self) -> bool {
        self.is_over.load(Ordering::Relaxed)
    }
}

/// Counts the packed bytes.
struct Counting<R> {
    inner: R,
    state: RawState,
}

impl<R: Read> Read for Counting<R> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let count = self.inner.read(buffer)?;
        self.state.bytes.fetch_add(count as u64, Ordering::Relaxed);
        if count == 0 && !buffer.is_empty() {
            self.state.is_over.store(true, Ordering::Relaxed);
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
    } else if head == ZSTD_MAGIC {
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
        Packing::Gzip => Box::new(MultiGzDecoder::new(raw)),
        Packing::Zstd => Box::new(ZstdFrames::new(raw)),
    };
    Ok((content, packing, state))
}

/// The frames of a Zstandard file, one after the other.
struct ZstdFrames<R: Read> {
    between: Option<BufReader<R>>,
    inside: Option<StreamingDecoder<BufReader<R>, FrameDecoder>>,
}

impl<R: Read> ZstdFrames<R> {
    fn new(raw: R) -> Self {
        Self {
            between: Some(BufReader::new(raw)),
            inside: None,
        }
    }
}

impl<R: Read> Read for ZstdFrames<R> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        loop {
            if let Some(frame) = &mut self.inside {
                let count = frame.read(buffer)?;
                if count > 0 || buffer.is_empty() {
                    return Ok(count);
                }
            }
            if let Some(frame) = self.inside.take() {
                self.between = Some(frame.into_inner());
            }
            let Some(mut raw) = self.between.take() else {
                return Ok(0);
            };
            if raw.fill_buf()?.is_empty() {
                self.between = Some(raw);
                return Ok(0);
            }
            let frame = StreamingDecoder::new_with_max_window_size(raw, MOST_WINDOW_BYTES);
            let frame = frame.map_err(|e| io::Error::new(ErrorKind::InvalidData, e.to_string()))?;
            self.inside = Some(frame);
        }
    }
}
