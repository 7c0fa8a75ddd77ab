//! Sizes of the pages of a Parquet file, checked before they are decoded. The decoder reserves what
//! a page header states, which for a damaged header can be all memory.
//!
//! Page headers are structs of Thrift's compact protocol (parquet.thrift, `PageHeader`):
//! <https://github.com/apache/thrift/blob/master/doc/specs/thrift-compact-protocol.md>.

use parquet::file::metadata::{ColumnChunkMetaData, ParquetMetaData};
use std::fs::File;
use std::io::{BufReader, Read, Seek, SeekFrom};

/// Largest page, bytes; writers make pages of about 1 MB.
const LARGEST_PAGE: i64 = 1 << 26;
/// Largest page header, bytes.
const LARGEST_HEADER: u64 = 1 << 16;
/// Deepest nesting of a page header.
const DEEPEST: usize = 8;

/// Checks every page of these columns.
///
/// # Errors
/// Returns what is wrong with the first page whose sizes are impossible.
pub(super) fn check(
    file: &File,
    metadata: &ParquetMetaData,
    columns: &[&str],
) -> Result<(), String> {
    let file_bytes = file.metadata().map_err(|e| e.to_string())?.len();
    let mut reader = BufReader::with_capacity(512, file);
    for group in metadata.row_groups() {
        for chunk in group.columns() {
            let path = chunk.column_path().string();
            if columns.contains(&&*path) {
                check_chunk(&mut reader, chunk, file_bytes)
                    .ok_or_else(|| format!("impossible size of a page of {path}"))?;
            }
        }
    }
    Ok(())
}

fn check_chunk(
    reader: &mut BufReader<&File>,
    chunk: &ColumnChunkMetaData,
    file_bytes: u64,
) -> Option<()> {
    let first = chunk.dictionary_page_offset();
    let first = first.unwrap_or_else(|| chunk.data_page_offset());
    let mut at = u64::try_from(first).ok()?;
    let length = u64::try_from(chunk.compressed_size()).ok()?;
    let end = at.checked_add(length).filter(|end| *end <= file_bytes)?;
    while at < end {
        reader.seek(SeekFrom::Start(at)).ok()?;
        let mut header = Thrift {
            bytes: reader.by_ref().take((end - at).min(LARGEST_HEADER)),
            read: 0,
        };
        let page = header.page()?;
        at = at.checked_add(header.read)?;
        let fits = (0..=LARGEST_PAGE).contains(&page.uncompressed)
            && (0..=page.uncompressed).contains(&page.dictionary_values);
        at = at.checked_add(u64::try_from(page.compressed).ok()?)?;
        if !fits || at > end {
            return None;
        }
    }
    Some(())
}

/// Sizes that a page header states.
#[derive(Default)]
struct PageSizes {
    uncompressed: i64,
    compressed: i64,
    /// Number of values of a dictionary page; each takes at least a byte.
    dictionary_values: i64,
}

/// A reader of Thrift's compact protocol that keeps nothing.
struct Thrift<R> {
    bytes: R,
    read: u64,
}

impl<R: Read> Thrift<R> {
    fn page(&mut self) -> Option<PageSizes> {
        let mut page = PageSizes::default();
        let mut last = 0;
        while let Some((field, kind)) = self.field(&mut last)? {
            match (field, kind) {
                (2, I32) => page.uncompressed = self.integer()?,
                (3, I32) => page.compressed = self.integer()?,
                (7, STRUCT) => page.dictionary_values = self.first_integer()?,
                _ => self.skip(kind, DEEPEST)?,
            }
        }
        Some(page)
    }

    /// Reads a struct and returns its field 1, an integer.
    fn first_integer(&mut self) -> Option<i64> {
        let (mut value, mut last) = (0, 0);
        while let Some((field, kind)) = self.field(&mut last)? {
            match (field, kind) {
                (1, I32) => value = self.integer()?,
                _ => self.skip(kind, DEEPEST)?,
            }
        }
        Some(value)
    }

    /// Reads the header of a field: its number and type; `Some(None)` at the end of the struct.
    #[expect(
        clippy::option_option,
        reason = "the outer one is that of damaged bytes"
    )]
    fn field(&mut self, last: &mut i64) -> Option<Option<(i64, u8)>> {
        let byte = self.byte()?;
        if byte == 0 {
            return Some(None);
        }
        *last = match byte >> 4 {
            0 => self.integer()?,
            step => last.checked_add(step.into())?,
        };
        Some(Some((*last, byte & 0xf)))
    }

    fn skip(&mut self, kind: u8, depth: usize) -> Option<()> {
        let depth = depth.checked_sub(1)?;
        match kind {
            // A boolean of a field is in its type.
            1 | 2 => Some(()),
            3 => self.byte().map(drop),
            4..=6 => self.integer().map(drop),
            7 => self.skip_bytes(8),
            BINARY => {
                let length = self.varint()?;
                self.skip_bytes(length)
            }
            9 | 10 => {
                let head = self.byte()?;
                let count = match head >> 4 {
                    15 => self.varint()?,
                    count => count.into(),
                };
                (0..count).try_for_each(|_| match head & 0xf {
                    1 | 2 => self.byte().map(drop),
                    kind => self.skip(kind, depth),
                })
            }
            STRUCT => {
                let mut last = 0;
                while let Some((_, kind)) = self.field(&mut last)? {
                    self.skip(kind, depth)?;
                }
                Some(())
            }
            _ => None,
        }
    }

    fn integer(&mut self) -> Option<i64> {
        let raw = self.varint()?;
        Some((raw >> 1) as i64 ^ -((raw & 1) as i64))
    }

    fn varint(&mut self) -> Option<u64> {
        let mut value = 0;
        for shift in (0..64).step_by(7) {
            let byte = self.byte()?;
            value |= u64::from(byte & 0x7f) << shift;
            if byte < 0x80 {
                return Some(value);
            }
        }
        None
    }

    fn skip_bytes(&mut self, count: u64) -> Option<()> {
        (0..count).try_for_each(|_| self.byte().map(drop))
    }

    fn byte(&mut self) -> Option<u8> {
        let mut byte = [0];
        self.bytes.read_exact(&mut byte).ok()?;
        self.read += 1;
        Some(byte[0])
    }
}

/// Types of fields.
const I32: u8 = 5;
const BINARY: u8 = 8;
const STRUCT: u8 = 12;
