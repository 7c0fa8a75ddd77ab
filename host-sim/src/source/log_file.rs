//! A log on disk, plain or gzip, as a stream of bytes.

use crate::error::{Error, Result};
use crate::files::limits::is_over_budget;
use flate2::read::MultiGzDecoder;
use std::fs::File;
use std::io::{self, Cursor, Read};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

/// First bytes of a gzip file (RFC 1952).
const GZIP_MAGIC: [u8; 2] = [0x1f, 0x8b];

/// A gzip file that expands to more than this, bytes, ...
const BOMB_BYTES: u64 = 64 << 20;
/// ... and more than so many times, is no log: the longest ones of a standing truck reach 60.
const BOMB_RATIO: u64 = 400;

/// An open log. Its first bytes, not its name, decide whether it is gzip.
pub struct LogFile {
    path: PathBuf,
    content: Box<dyn Read + Send>,
    is_gzip: bool,
    bytes_read: Arc<AtomicU64>,
    bytes_total: u64,
    bytes_expanded: u64,
}

/// Counts the bytes read from the disk, before decompression.
struct Counting<R> {
    inner: R,
    bytes: Arc<AtomicU64>,
}

impl<R: Read> Read for Counting<R> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let count = self.inner.read(buffer)?;
        self.bytes.fetch_add(count as u64, Ordering::Relaxed);
        Ok(count)
    }
}

impl LogFile {
    /// Opens a log.
    ///
    /// # Errors
    /// Returns an error if the file cannot be opened or is a folder.
    pub fn open(path: &Path) -> Result<Self> {
        let mut file = File::open(path).map_err(Error::io(path))?;
        let metadata = file.metadata().map_err(Error::io(path))?;
        if metadata.is_dir() {
            return Err(Error::content(path, "is a folder; expected a file"));
        }
        let mut head = Vec::new();
        file.by_ref()
            .take(GZIP_MAGIC.len() as u64)
            .read_to_end(&mut head)
            .map_err(Error::io(path))?;
        let is_gzip = head == GZIP_MAGIC;
        let bytes_read = Arc::new(AtomicU64::new(0));
        // Chained, not rewound: a pipe cannot be rewound.
        let raw = Counting {
            inner: Cursor::new(head).chain(file),
            bytes: Arc::clone(&bytes_read),
        };
        let content: Box<dyn Read + Send> = if is_gzip {
            Box::new(MultiGzDecoder::new(raw))
        } else {
            Box::new(raw)
        };
        Ok(Self {
            path: path.to_owned(),
            content,
            is_gzip,
            bytes_read,
            bytes_total: metadata.len(),
            bytes_expanded: 0,
        })
    }

    /// Returns the path of the log.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Returns the number of bytes read from the disk so far.
    #[must_use]
    pub fn bytes_read(&self) -> u64 {
        self.bytes_read.load(Ordering::Relaxed)
    }

    /// Returns the size on the disk, bytes; 0 for a pipe.
    #[must_use]
    pub const fn bytes_total(&self) -> u64 {
        self.bytes_total
    }

    /// Returns the error of a failed read near `line`.
    #[must_use]
    pub fn read_error(&self, line: u64, error: io::Error) -> Error {
        if is_over_budget(&error) {
            Error::line(&self.path, line, error.to_string(), "lines of text")
        } else if self.is_gzip {
            Error::line(
                &self.path,
                line,
                format!("the gzip data are truncated or damaged ({error})"),
                "a complete gzip file",
            )
        } else {
            Error::io(&self.path)(error)
        }
    }
}

impl Read for LogFile {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let count = self.content.read(buffer)?;
        if self.is_gzip {
            self.bytes_expanded += count as u64;
            if self.bytes_expanded > BOMB_BYTES.max(BOMB_RATIO * self.bytes_read()) {
                let problem = format!("the gzip data expand more than {BOMB_RATIO} times");
                return Err(io::Error::new(io::ErrorKind::FileTooLarge, problem));
            }
        }
        Ok(count)
    }
}
