//! The objects of a BLF file, inside and outside of its containers, as one stream.

use super::blf_layout::{
    BASE_BYTES, CONTAINER, Flaw, MOST_PADDING, OBJECT_MAGIC, beginning, container_within, size_of,
    unpack,
};
use super::byte_file::{ByteFile, u16_at, u32_at};
use super::calendar::DateTime;
use crate::error::{Error, Result};
use crate::files::log_format::BLF_MAGIC;
use crate::source::damage::DamageCheck;
use crate::source::log_file::LogFile;
use memchr::memmem;
use std::ops::Range;

/// Bytes of the file header that are read for its length.
const LENGTH_BYTES: u64 = 8;
/// Largest file header, bytes; Vector's has 144.
const MOST_HEADER_BYTES: u64 = 64 << 10;

/// Where the start of the measurement stands in the file header: eight numbers of two bytes, year,
/// month, day of the week, day, hour, minute, second, millisecond.
const START_AT: usize = 40;

/// Reader of objects.
pub(super) struct Containers {
    file: ByteFile,
    /// Where the newest object of the file begins.
    object_at: u64,
    is_open: bool,
    origin_us: Option<u64>,
    /// An object of the file.
    packed: Vec<u8>,
    /// Content of containers, of which `used` bytes were handed out.
    stream: Vec<u8>,
    used: usize,
    /// True if the rest of the stream continues in a container that is lost.
    is_torn: bool,
    /// True if the stream may begin within an object.
    is_within: bool,
    /// True if no good object of the file came since the last damage.
    is_damaged: bool,
    /// True if the file has no more objects.
    is_over: bool,
}

impl Containers {
    pub(super) fn new(file: LogFile) -> Self {
        Self {
            file: ByteFile::new(file),
            object_at: 0,
            is_open: false,
            origin_us: None,
            packed: Vec::new(),
            stream: Vec::new(),
            used: 0,
            is_torn: false,
            is_within: false,
            is_damaged: false,
            is_over: false,
        }
    }

    pub(super) fn file(&self) -> &LogFile {
        self.file.log()
    }

    /// Returns the start of the measurement, in microseconds since the Unix epoch. The file does not
    /// tell the time zone.
    pub(super) const fn origin_us(&self) -> Option<u64> {
        self.origin_us
    }

    /// Returns the bytes of an object.
    pub(super) fn bytes(&self, object: Range<usize>) -> &[u8] {
        self.stream.get(object).unwrap_or_default()
    }

    /// Returns the error of an object.
    pub(super) fn error(&self, problem: &str, expected: &str) -> Error {
        let at = self.object_at;
        let problem = format!("{problem}, in the object at byte {at}; expected {expected}");
        Error::content(self.file().path(), problem)
    }

    /// Goes to the next object; `None` at the end.
    ///
    /// # Errors
    /// Returns an error of the disk or of the decompression, and what `damage` does not allow.
    pub(super) fn next_object(&mut self, damage: &mut DamageCheck) -> Result<Option<Range<usize>>> {
        if !self.is_open {
            self.read_header()?;
            self.is_open = true;
        }
        loop {
            if let Some(object) = self.next_in_stream(damage)? {
                return Ok(Some(object));
            }
            self.stream.drain(..self.used);
            self.used = 0;
            if self.is_torn {
                self.stream.clear();
                self.is_torn = false;
                self.is_within = true;
            }
            if self.is_over {
                let is_rest = self.stream.len() > MOST_PADDING && !self.is_within;
                if is_rest {
                    self.cut_off(damage)?;
                }
                return Ok(None);
            }
            // The last container may be cut off, and have objects.
            self.is_over = !self.fetch(damage)?;
        }
    }

    fn cut_off(&self, damage: &mut DamageCheck) -> Result<()> {
        damage.cut_off(self.error("the log is cut off", "a whole object"))
    }

    fn read_header(&mut self) -> Result<()> {
        self.file.take(&mut self.packed, LENGTH_BYTES)?;
        let Some(length) = u32_at(&self.packed, BLF_MAGIC.len()) else {
            return Ok(());
        };
        let rest = u64::from(length).checked_sub(LENGTH_BYTES);
        let Some(rest) = rest.filter(|rest| *rest <= MOST_HEADER_BYTES) else {
            return Err(self.error(&format!("a file header of {length} bytes"), "144"));
        };
        self.file.take_more(&mut self.packed, rest)?;
        let part = |k: usize| u16_at(&self.packed, START_AT + 2 * k).map(u64::from);
        if let (Some(year), Some(month), Some(day)) = (part(0), part(1), part(3)) {
            let of_day = |k| part(k).unwrap_or_default();
            let start = DateTime {
                year,
                month,
                day,
                hour: of_day(4),
                minute: of_day(5),
                second: of_day(6),
                micros: of_day(7) * 1000,
            };
            self.origin_us = start.unix_micros();
        }
        Ok(())
    }

    /// Returns the next whole object of the stream.
    fn next_in_stream(&mut self, damage: &mut DamageCheck) -> Result<Option<Range<usize>>> {
        loop {
            let rest = self.stream.get(self.used..).unwrap_or_default();
            if rest.len() < MOST_PADDING + BASE_BYTES {
                return Ok(None);
            }
            let flaw = match beginning(rest) {
                None => Flaw::no_object(),
                Some(padding) => match size_of(rest.get(padding..).unwrap_or_default()) {
                    Ok(size) if rest.len() < padding + size => return Ok(None),
                    Ok(size) => {
                        let object = self.used + padding..self.used + padding + size;
                        self.used = object.end;
                        self.is_within = false;
                        return Ok(Some(object));
                    }
                    Err(flaw) => flaw,
                },
            };
            let next = memmem::find(rest.get(1..).unwrap_or_default(), OBJECT_MAGIC);
            // The letters may continue in the next container.
            let lost = next.map_or(rest.len() - OBJECT_MAGIC.len(), |at| at + 1);
            if !self.is_within {
                self.is_within = true;
                damage.block(self.error(&flaw.what, &flaw.expected), lost as u64)?;
            }
            self.used += lost;
            if next.is_none() {
                return Ok(None);
            }
        }
    }

    /// Reads the next object of the file to the end of the stream: itself, or what is in it if it is
    /// a container. Returns false at the end of the file.
    fn fetch(&mut self, damage: &mut DamageCheck) -> Result<bool> {
        self.object_at = self.file.offset();
        if !self.file.take(&mut self.packed, BASE_BYTES as u64)? {
            if self.packed.len() > MOST_PADDING {
                self.cut_off(damage)?;
            }
            return Ok(false);
        }
        let Some(padding) = beginning(&self.packed) else {
            return self.skip_damage(&Flaw::no_object(), damage);
        };
        self.packed.drain(..padding);
        self.object_at += padding as u64;
        if !self.file.take_more(&mut self.packed, padding as u64)? {
            self.cut_off(damage)?;
            return Ok(false);
        }
        let size = match size_of(&self.packed) {
            Ok(size) => size,
            Err(flaw) => return self.skip_damage(&flaw, damage),
        };
        let rest = (size - BASE_BYTES) as u64;
        let is_whole = self.file.take_more(&mut self.packed, rest)?;
        if let Some(at) = (!is_whole)
            .then(|| container_within(&self.packed))
            .flatten()
        {
            return self.give_back(at, &Flaw::no_object(), damage);
        }
        if !is_whole {
            self.cut_off(damage)?;
        }
        if u32_at(&self.packed, 12) != Some(CONTAINER) {
            self.stream.extend_from_slice(&self.packed);
        } else if let Err(flaw) = unpack(&self.packed, is_whole, &mut self.stream) {
            self.is_torn = true;
            let end = container_within(&self.packed).unwrap_or(self.packed.len());
            return self.give_back(end, &flaw, damage);
        }
        self.is_damaged = false;
        Ok(is_whole)
    }

    /// Leaves out the file up to the next object.
    fn skip_damage(&mut self, flaw: &Flaw, damage: &mut DamageCheck) -> Result<bool> {
        self.is_torn = true;
        let lost = self.file.skip_to(&mut self.packed, OBJECT_MAGIC)?;
        self.count(flaw, lost, damage)?;
        Ok(true)
    }

    /// Leaves out the object up to a place in it, and reads on from there.
    fn give_back(&mut self, at: usize, flaw: &Flaw, damage: &mut DamageCheck) -> Result<bool> {
        self.is_torn = true;
        self.file
            .give_back(self.packed.get(at..).unwrap_or_default());
        self.count(flaw, at as u64, damage)?;
        Ok(true)
    }

    /// Counts a damaged block, once until a good one follows.
    fn count(&mut self, flaw: &Flaw, bytes: u64, damage: &mut DamageCheck) -> Result<()> {
        if std::mem::replace(&mut self.is_damaged, true) {
            damage.more_of_block(bytes);
            return Ok(());
        }
        damage.block(self.error(&flaw.what, &flaw.expected), bytes)
    }
}
