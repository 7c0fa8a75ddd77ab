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

/// Bytes that decide on the kind of a log, those inside of a gzip file.
const HEAD_BYTES: u64 = 4 << 10;
/// Mark of UTF-8, with which some programs begin a text.
const BYTE_ORDER_MARK: &[u8] = b"\xef\xbb\xbf";

/// An open log. Its first bytes, not its name, decide whether it is gzip.
pub struct LogFile {
    path: PathBuf,
    content: Box<dyn Read + Send>,
    is_gzip: bool,
    bytes_read: Arc<AtomicU64>,
    bytes_total: u64,
    bytes_expanded: u64,
    /// The first bytes, if they were looked at, and how many of them were read again.
    head: Vec<u8>,
    head_taken: usize,
    /// The error behind the head, until the reader comes there.
    head_error: Option<io::Error>,
    may_be_cut_off: bool,
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
            head: Vec::new(),
            head_taken: 0,
            head_error: None,
            may_be_cut_off: false,
        })
    }

    /// Returns the first bytes, without a byte order mark. They are read again afterwards, from a
    /// pipe too. An error among them comes when the reader gets there.
    pub(super) fn look_at_head(&mut self) -> &[u8] {
        let mut head = Vec::new();
        let read = self.by_ref().take(HEAD_BYTES).read_to_end(&mut head);
        self.head_error = read.err();
        if head.starts_with(BYTE_ORDER_MARK) {
            self.head_taken = BYTE_ORDER_MARK.len();
        }
        self.head = head;
        self.head.get(self.head_taken..).unwrap_or_default()
    }

    /// Lets gzip data that are cut off end like those that are whole.
    pub(super) const fn allow_cut_off(&mut self) {
        self.may_be_cut_off = true;
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

impl LogFile {
    /// Returns the error of a failed read of a binary log near byte `offset`.
    pub(super) fn read_error_at(&self, offset: u64, error: io::Error) -> Error {
        if is_over_budget(&error) {
            Error::content(&self.path, format!("{error}; expected a log"))
        } else if self.is_gzip {
            let problem = format!("the gzip data are damaged at byte {offset} ({error})");
            Error::content(&self.path, problem + "; expected a complete gzip file")
        } else {
            Error::io(&self.path)(error)
        }
    }

    fn is_cut_off(&self, error: &io::Error) -> bool {
        self.may_be_cut_off && self.is_gzip && error.kind() == io::ErrorKind::UnexpectedEof
    }

    fn read_content(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        if let Some(error) = self.head_error.take() {
            return Err(error);
        }
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

impl Read for LogFile {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        if let Some(rest) = self.head.get(self.head_taken..)
            && !rest.is_empty()
        {
            let count = rest.len().min(buffer.len());
            buffer[..count].copy_from_slice(&rest[..count]);
            self.head_taken += count;
            return Ok(count);
        }
        match self.read_content(buffer) {
            Err(e) if self.is_cut_off(&e) => Ok(0),
            other => other,
        }
    }
}
