//! A log on disk or from a pipe, plain or packed, as a stream of bytes.

use super::log_stream::unpacked;
use super::packing::{Joint, Packing, RawState};
use crate::error::{Error, Result};
use crate::files::limits::is_over_budget;
use crate::files::marks::BYTE_ORDER_MARK;
use encoding_rs_io::DecodeReaderBytes;
use std::fs::File;
use std::io::{self, Cursor, ErrorKind, Read};
use std::path::{Path, PathBuf};

/// Packed data that expand to more than this, bytes, ...
const BOMB_BYTES: u64 = 64 << 20;
/// ... and more than so many times, are no log: the longest ones of a standing truck reach 60.
const BOMB_RATIO: u64 = 400;

/// Bytes that decide on the kind of a log, those inside of a packed file.
const HEAD_BYTES: u64 = 4 << 10;
/// Marks of UTF-16.
const WIDE_MARKS: [&[u8]; 2] = [b"\xff\xfe", b"\xfe\xff"];
/// The name of standard input.
const STANDARD_INPUT: &str = "-";

/// An open log. Its first bytes, not its name, decide how it is packed. One that is cut off ends
/// there. One whose packed data are damaged ends there too, or goes on at the next member, if
/// `join` said how.
pub struct LogFile {
    path: PathBuf,
    content: Box<dyn Read + Send>,
    packing: Packing,
    raw: RawState,
    bytes_total: u64,
    bytes_expanded: u64,
    /// The first bytes, if they were looked at, and how many of them were read again.
    head: Vec<u8>,
    head_taken: usize,
    /// The error behind the head, until the reader comes there.
    head_error: Option<io::Error>,
    newest_byte: Option<u8>,
    is_cut_off: bool,
    is_wide: bool,
}

/// Returns true if this path means standard input.
pub fn is_standard_input(path: &Path) -> bool {
    path.as_os_str() == STANDARD_INPUT
}

impl LogFile {
    /// Opens a log; `-` is standard input.
    ///
    /// # Errors
    /// Returns an error if the file cannot be opened or is a folder.
    pub fn open(path: &Path) -> Result<Self> {
        let (opened, bytes_total) = if is_standard_input(path) {
            (unpacked(io::stdin()), 0)
        } else {
            let file = File::open(path).map_err(Error::io(path))?;
            let metadata = file.metadata().map_err(Error::io(path))?;
            if metadata.is_dir() {
                return Err(Error::content(path, "is a folder; expected a file"));
            }
            (unpacked(file), metadata.len())
        };
        let (content, packing, raw) = opened.map_err(Error::io(path))?;
        Ok(Self {
            path: path.to_owned(),
            content,
            packing,
            raw,
            bytes_total,
            bytes_expanded: 0,
            head: Vec::new(),
            head_taken: 0,
            head_error: None,
            newest_byte: None,
            is_cut_off: false,
            is_wide: false,
        })
    }

    /// Returns the first bytes, in UTF-8 if they are text, without a byte order mark. They are read
    /// again afterwards, from a pipe too. An error among them comes when the reader gets there.
    pub(crate) fn look_at_head(&mut self) -> &[u8] {
        if !self.head.is_empty() {
            return self.head.get(self.head_taken..).unwrap_or_default();
        }
        self.read_head();
        if WIDE_MARKS.iter().any(|mark| self.head.starts_with(mark)) {
            self.is_wide = true;
            let head = Cursor::new(std::mem::take(&mut self.head));
            let rest = std::mem::replace(&mut self.content, Box::new(io::empty()));
            self.content = Box::new(DecodeReaderBytes::new(head.chain(rest)));
            self.read_head();
        }
        if self.head.starts_with(BYTE_ORDER_MARK) {
            self.head_taken = BYTE_ORDER_MARK.len();
        }
        self.head.get(self.head_taken..).unwrap_or_default()
    }

    fn read_head(&mut self) {
        let mut head = Vec::new();
        let read = self.by_ref().take(HEAD_BYTES).read_to_end(&mut head);
        self.head_error = read.err();
        self.head = head;
    }

    /// Returns the path of the log.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Returns the number of bytes read from the disk so far.
    #[must_use]
    pub fn bytes_read(&self) -> u64 {
        self.raw.bytes()
    }

    /// Counts bytes that a reader took from the seekable file.
    pub(super) fn note_read(&self, bytes: u64) {
        if self.packing == Packing::Plain {
            self.raw.add(bytes);
        }
    }

    /// Returns the size on the disk, bytes; 0 for a pipe.
    #[must_use]
    pub const fn bytes_total(&self) -> u64 {
        self.bytes_total
    }

    /// Returns true if the packed data ended before their time.
    pub(super) const fn is_cut_off(&self) -> bool {
        self.is_cut_off
    }

    /// Says how to go on behind damage of packed data. In UTF-16, half a character may be lost, so
    /// that the log ends at the damage.
    pub(super) fn join(&self, joint: Joint) {
        if !self.is_wide {
            self.raw.set_joint(joint);
        }
    }

    /// Asks to leave out the rest of the member of packed data whose content is damaged, `ahead` bytes
    /// before the newest one. Returns how many of these are to be left out: those that are not of a later
    /// member. `None` if the log is not packed.
    pub(super) fn skip_member(&self, ahead: usize) -> Option<usize> {
        if self.packing == Packing::Plain || self.raw.joint() != Joint::Lines {
            return None;
        }
        let start = self.raw.member_start();
        let here = self.bytes_expanded.saturating_sub(ahead as u64);
        if start > here {
            // The newest bytes are of a later member already.
            return Some((start - here) as usize);
        }
        self.raw.ask_to_skip();
        Some(ahead)
    }

    /// Returns the damage within packed data: what is wrong, and how many bytes are left out.
    pub(super) fn packed_damage(&self) -> Vec<(Error, u64)> {
        let name = self.packing.name();
        let damage = self.raw.packed_damage(self.bytes_total).into_iter();
        let error = |at, problem| {
            let problem = format!("the {name} data are damaged at byte {at} ({problem})");
            let problem = format!("{problem}; expected a complete {name} file");
            Error::content(&self.path, problem)
        };
        damage
            .map(|found| (error(found.at, found.problem), found.bytes))
            .collect()
    }

    /// Returns the last byte that was read.
    pub(super) const fn newest_byte(&self) -> Option<u8> {
        self.newest_byte
    }

    /// Returns the error for packed data that are cut off.
    pub(super) fn cut_off_error(&self) -> Error {
        let name = self.packing.name();
        let problem = format!("the {name} data are cut off; expected a complete {name} file");
        Error::content(&self.path, problem)
    }

    /// Returns the log as a file in which one can go back: itself, or a temporary copy.
    ///
    /// # Errors
    /// Returns the error of the file system or of the packed data.
    pub(super) fn open_seekable(&mut self) -> Result<File> {
        let is_plain = self.packing == Packing::Plain && self.path.is_file();
        if is_plain {
            return File::open(&self.path).map_err(Error::io(&self.path));
        }
        let folder = tempfile::env::temp_dir();
        let mut copy = tempfile::tempfile().map_err(Error::io(&folder))?;
        let mut buffer = vec![0; 1 << 16];
        loop {
            let count = match self.read(&mut buffer) {
                Ok(0) => return Ok(copy),
                Ok(count) => count,
                Err(e) if e.kind() == ErrorKind::Interrupted => continue,
                Err(e) => return Err(self.read_error_at(self.bytes_expanded, e)),
            };
            let part = buffer.get(..count).unwrap_or_default();
            io::Write::write_all(&mut copy, part).map_err(Error::io(&folder))?;
        }
    }

    /// Returns the error of a failed read near `line`.
    #[must_use]
    pub fn read_error(&self, line: u64, error: io::Error) -> Error {
        if is_over_budget(&error) {
            return Error::line(&self.path, line, error.to_string(), "lines of text");
        }
        match self.packing {
            Packing::Plain => Error::io(&self.path)(error),
            packing => {
                let name = packing.name();
                let problem = format!("the {name} data are truncated or damaged ({error})");
                Error::line(&self.path, line, problem, format!("a complete {name} file"))
            }
        }
    }

    /// Returns the error of a failed read of a binary log near byte `offset`.
    pub(super) fn read_error_at(&self, offset: u64, error: io::Error) -> Error {
        if is_over_budget(&error) {
            return Error::content(&self.path, format!("{error}; expected a log"));
        }
        match self.packing {
            Packing::Plain => Error::io(&self.path)(error),
            packing => {
                let name = packing.name();
                let problem = format!("the {name} data are damaged at byte {offset} ({error})");
                let problem = format!("{problem}; expected a complete {name} file");
                Error::content(&self.path, problem)
            }
        }
    }

    /// Returns true if this error means that the packed data end too early, or that what stands
    /// behind them is not packed: blocks of a disk that were never written.
    fn is_end(&self, error: &io::Error) -> bool {
        self.packing != Packing::Plain && error.kind() == ErrorKind::UnexpectedEof
    }

    fn read_content(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        if let Some(error) = self.head_error.take() {
            return Err(error);
        }
        if self.is_cut_off {
            return Ok(0);
        }
        let count = self.content.read(buffer)?;
        if self.packing != Packing::Plain {
            self.bytes_expanded += count as u64;
            if self.bytes_expanded > BOMB_BYTES.max(BOMB_RATIO * self.bytes_read()) {
                let name = self.packing.name();
                let problem = format!("the {name} data expand more than {BOMB_RATIO} times");
                return Err(io::Error::new(ErrorKind::FileTooLarge, problem));
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
            self.newest_byte = self.head.get(self.head_taken.wrapping_sub(1)).copied();
            return Ok(count);
        }
        let count = match self.read_content(buffer) {
            Err(e) if self.is_end(&e) => {
                self.is_cut_off = true;
                0
            }
            other => other?,
        };
        if let Some(last) = count.checked_sub(1) {
            self.newest_byte = buffer.get(last).copied();
        }
        Ok(count)
    }
}
