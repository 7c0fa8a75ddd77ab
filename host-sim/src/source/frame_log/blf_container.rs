//! The objects of a BLF file, inside and outside of its containers, as one stream.

use crate::error::{Error, Result};
use crate::files::log_format::BLF_MAGIC;
use crate::source::log_file::LogFile;
use flate2::read::ZlibDecoder;
use std::io::{BufReader, ErrorKind, Read};
use std::ops::Range;

/// First bytes of an object.
const OBJECT_MAGIC: &[u8] = b"LOBJ";
/// Bytes of the part of an object's header that all objects have.
const BASE_BYTES: usize = 16;
/// Bytes of a container between that part and its content.
const CONTAINER_BYTES: usize = 16;
/// Type of a container.
const CONTAINER: u32 = 10;
/// Most bytes between two objects: writers differ in how they pad.
const MOST_PADDING: usize = 4;
/// Bytes of the file header that are read for its length.
const LENGTH_BYTES: u64 = 8;
/// Largest object, container or content of a container, bytes. Vector's are 128 KiB.
const MOST_BYTES: usize = 64 << 20;
/// Largest file header, bytes; Vector's has 144.
const MOST_HEADER_BYTES: u64 = 64 << 10;

const METHOD_NONE: u16 = 0;
const METHOD_ZLIB: u16 = 2;

/// Reader of objects.
pub(super) struct Containers {
    file: BufReader<LogFile>,
    /// Bytes of the file that were taken.
    offset: u64,
    /// Where the newest object of the file begins.
    object_at: u64,
    is_open: bool,
    /// An object of the file.
    packed: Vec<u8>,
    /// Content of containers, of which `used` bytes were handed out.
    stream: Vec<u8>,
    used: usize,
}

/// Returns the number at a place of some bytes, if it is inside.
pub(super) fn number<const N: usize>(bytes: &[u8], at: usize) -> Option<[u8; N]> {
    bytes.get(at..)?.first_chunk().copied()
}

pub(super) fn u16_at(bytes: &[u8], at: usize) -> Option<u16> {
    number(bytes, at).map(u16::from_le_bytes)
}

pub(super) fn u32_at(bytes: &[u8], at: usize) -> Option<u32> {
    number(bytes, at).map(u32::from_le_bytes)
}

/// Returns where in these bytes the next object begins, behind its padding.
fn beginning(bytes: &[u8]) -> Option<usize> {
    (0..=MOST_PADDING).find(|at| {
        bytes
            .get(*at..)
            .is_some_and(|b| b.starts_with(OBJECT_MAGIC))
    })
}

impl Containers {
    pub(super) fn new(file: LogFile) -> Self {
        Self {
            file: BufReader::new(file),
            offset: 0,
            object_at: 0,
            is_open: false,
            packed: Vec::new(),
            stream: Vec::new(),
            used: 0,
        }
    }

    pub(super) fn file(&self) -> &LogFile {
        self.file.get_ref()
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
    /// Returns an error of the disk or of the decompression, or for bytes that are no object.
    pub(super) fn next_object(&mut self) -> Result<Option<Range<usize>>> {
        if !self.is_open {
            self.skip_header()?;
            self.is_open = true;
        }
        loop {
            if let Some(object) = self.next_in_stream()? {
                return Ok(Some(object));
            }
            self.stream.drain(..self.used);
            self.used = 0;
            if !self.fetch()? {
                return Ok(None);
            }
        }
    }

    fn skip_header(&mut self) -> Result<()> {
        self.take(LENGTH_BYTES)?;
        let Some(length) = u32_at(&self.packed, BLF_MAGIC.len()) else {
            return Ok(());
        };
        let rest = u64::from(length).checked_sub(LENGTH_BYTES);
        match rest.filter(|rest| *rest <= MOST_HEADER_BYTES) {
            Some(rest) => self.take(rest).map(|_| ()),
            None => Err(self.error(&format!("a file header of {length} bytes"), "144")),
        }
    }

    /// Returns the next whole object of the stream.
    fn next_in_stream(&mut self) -> Result<Option<Range<usize>>> {
        let rest = self.stream.get(self.used..).unwrap_or_default();
        if rest.len() < MOST_PADDING + BASE_BYTES {
            return Ok(None);
        }
        let Some(padding) = beginning(rest) else {
            return Err(self.no_object());
        };
        let size = self.size(rest.get(padding..).unwrap_or_default())?;
        let end = padding + size;
        if rest.len() < end {
            return Ok(None);
        }
        let object = self.used + padding..self.used + end;
        self.used = object.end;
        Ok(Some(object))
    }

    /// Returns the size of an object by its header.
    fn size(&self, header: &[u8]) -> Result<usize> {
        let size = u32_at(header, 8).map_or(0, |size| size as usize);
        if (BASE_BYTES..=MOST_BYTES).contains(&size) {
            return Ok(size);
        }
        let expected = format!("{BASE_BYTES} to {MOST_BYTES}");
        Err(self.error(&format!("an object of {size} bytes"), &expected))
    }

    /// Reads the next object of the file to the end of the stream: itself, or what is in it if it is
    /// a container. Returns false at the end of the file.
    fn fetch(&mut self) -> Result<bool> {
        self.object_at = self.offset;
        if !self.take(BASE_BYTES as u64)? {
            return Ok(false);
        }
        let Some(padding) = beginning(&self.packed) else {
            return Err(self.no_object());
        };
        self.packed.drain(..padding);
        self.object_at += padding as u64;
        if !self.take_more(padding as u64)? {
            return Ok(false);
        }
        let size = self.size(&self.packed)?;
        let is_whole = self.take_more((size - BASE_BYTES) as u64)?;
        if u32_at(&self.packed, 12) != Some(CONTAINER) {
            self.stream.extend_from_slice(&self.packed);
        } else {
            self.unpack(is_whole)?;
        }
        Ok(is_whole)
    }

    fn unpack(&mut self, is_whole: bool) -> Result<()> {
        let declared = u32_at(&self.packed, BASE_BYTES + 8);
        let (Some(method), Some(declared), Some(content)) = (
            u16_at(&self.packed, BASE_BYTES),
            declared.map(|size| size as usize),
            self.packed.get(BASE_BYTES + CONTAINER_BYTES..),
        ) else {
            return if is_whole {
                Err(self.error("a container without header", "at least 32 bytes"))
            } else {
                Ok(())
            };
        };
        if declared > MOST_BYTES {
            let expected = format!("at most {MOST_BYTES}");
            return Err(self.error(&format!("a container of {declared} bytes"), &expected));
        }
        match method {
            METHOD_NONE => self.stream.extend_from_slice(content),
            METHOD_ZLIB => {
                let before = self.stream.len();
                // One byte more than declared shows that there is more.
                let most = declared as u64 + 1;
                let mut content = ZlibDecoder::new(content).take(most);
                match content.read_to_end(&mut self.stream) {
                    Err(e) if is_whole || e.kind() != ErrorKind::UnexpectedEof => {
                        let what = format!("damaged zlib data ({e})");
                        return Err(self.error(&what, "a whole container"));
                    }
                    _ => {}
                }
                if self.stream.len() - before > declared {
                    let what =
                        format!("a container with more than the {declared} bytes it declares");
                    return Err(self.error(&what, "as many"));
                }
            }
            _ => {
                let what = format!("compression method {method}");
                return Err(self.error(&what, "0 (none) or 2 (zlib)"));
            }
        }
        Ok(())
    }

    fn no_object(&self) -> Error {
        self.error("no object behind the one before", "the letters LOBJ")
    }

    /// Reads so many bytes; returns false if the file ends before.
    fn take(&mut self, count: u64) -> Result<bool> {
        self.packed.clear();
        self.take_more(count)
    }

    fn take_more(&mut self, count: u64) -> Result<bool> {
        let before = self.packed.len();
        let read = self.file.by_ref().take(count).read_to_end(&mut self.packed);
        self.offset += (self.packed.len() - before) as u64;
        match read {
            Ok(read) => Ok(read as u64 == count),
            Err(e) => Err(self.file().read_error_at(self.offset, e)),
        }
    }
}
