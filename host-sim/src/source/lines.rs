//! The lines of a log, one at a time, without copies.

use super::log_file::LogFile;
use crate::error::{Error, Result};
use memchr::memchr;
use std::io::{self, Read};
use std::ops::Range;

/// Number of bytes read at once, and the maximum length of a line.
const BUFFER_BYTES: usize = 256 * 1024;

/// Maximum length of the quote of a line in a message, bytes.
const QUOTE_BYTES: usize = 60;

/// Reader of lines; its memory does not depend on the length of the log.
pub(super) struct Lines {
    file: LogFile,
    buffer: Vec<u8>,
    /// Bytes read but not yet returned.
    waiting: Range<usize>,
    /// The current line, without its end.
    line: Range<usize>,
    number: u64,
    has_end: bool,
}

impl Lines {
    pub(super) fn new(file: LogFile) -> Self {
        Self {
            file,
            buffer: vec![0; BUFFER_BYTES],
            waiting: 0..0,
            line: 0..0,
            number: 0,
            has_end: true,
        }
    }

    pub(super) const fn file(&self) -> &LogFile {
        &self.file
    }

    /// Returns the number of the current line, from 1.
    pub(super) const fn number(&self) -> u64 {
        self.number
    }

    /// Returns the current line, without its end.
    pub(super) fn line(&self) -> &[u8] {
        &self.buffer[self.line.clone()]
    }

    /// Quotes the start of the current line, with non-printable bytes escaped.
    pub(super) fn quote(&self) -> String {
        let line = self.line();
        let head = &line[..line.len().min(QUOTE_BYTES)];
        let dots = if head.len() < line.len() { "…" } else { "" };
        format!("{}{dots}", head.escape_ascii())
    }

    /// Returns true if the current line has bytes that no text has.
    pub(super) fn is_binary(&self) -> bool {
        let is_odd = |byte: &u8| byte.is_ascii_control() && *byte != b'\t';
        self.line().iter().any(is_odd)
    }

    /// Returns true if the current line ends in a line feed; only the last line may lack it.
    pub(super) const fn has_end(&self) -> bool {
        self.has_end
    }

    /// Goes to the next line. Returns false at the end of the file.
    ///
    /// # Errors
    /// Returns an error of the disk or of the decompression, or for a line without end.
    pub(super) fn advance(&mut self) -> Result<bool> {
        let mut searched = 0;
        loop {
            let waiting = &self.buffer[self.waiting.clone()];
            if let Some(found) = memchr(b'\n', waiting.get(searched..).unwrap_or_default()) {
                self.hand_out(searched + found, true);
                return Ok(true);
            }
            let before = waiting.len();
            let count = self.fetch()?;
            searched = before.min(self.waiting.len() - count);
            if count == 0 {
                let is_left = !self.waiting.is_empty();
                if is_left {
                    self.hand_out(self.waiting.len(), false);
                }
                return Ok(is_left);
            }
        }
    }

    /// Leaves out the rest of a member of packed data: its lines are damaged.
    pub(super) fn skip_member(&mut self) {
        if let Some(left_out) = self.file.skip_member(self.waiting.len()) {
            self.waiting.start = (self.waiting.start + left_out).min(self.waiting.end);
        }
    }

    fn hand_out(&mut self, length: usize, has_end: bool) {
        let start = self.waiting.start;
        let end = start + length;
        self.waiting.start = end + usize::from(has_end);
        let is_dos = self.buffer[start..end].ends_with(b"\r");
        self.line = start..end - usize::from(is_dos);
        self.number += 1;
        self.has_end = has_end;
    }

    /// Reads more bytes; returns 0 at the end of the file.
    fn fetch(&mut self) -> Result<usize> {
        self.buffer.copy_within(self.waiting.clone(), 0);
        self.waiting = 0..self.waiting.len();
        if self.waiting.end == self.buffer.len() && self.buffer.iter().all(|byte| *byte == 0) {
            // Blocks of the disk that were never written: the logger lost its power.
            self.waiting = 0..1;
        }
        if self.waiting.end == self.buffer.len() {
            return Err(Error::line(
                self.file.path(),
                self.number + 1,
                format!("no line end within {BUFFER_BYTES} bytes"),
                "lines of text",
            ));
        }
        loop {
            match self.file.read(&mut self.buffer[self.waiting.end..]) {
                Ok(count) => {
                    self.waiting.end += count;
                    return Ok(count);
                }
                Err(e) if e.kind() == io::ErrorKind::Interrupted => {}
                Err(e) => return Err(self.file.read_error(self.number + 1, e)),
            }
        }
    }
}
