//! The data of a group or of a channel: one block, or a list of blocks, plain or compressed.

use super::mdf_file::{Block, HEADER_BYTES, MdfFile, u32_at, u64_at};
use crate::error::{Error, Result};
use flate2::read::ZlibDecoder;
use lz4_flex::frame::FrameDecoder;
use ruzstd::decoding::StreamingDecoder;
use std::collections::VecDeque;
use std::io::{self, Read};

/// Bytes of a plain block that are read at once.
const STEP_BYTES: u64 = 1 << 18;
/// Largest compressed block, bytes, packed or unpacked. Writers use up to 4 MiB.
const MOST_BYTES: u64 = 16 << 20;
/// Bytes of a compressed block before its content.
const PACKED_HEADER_BYTES: u64 = 24;
/// Most blocks of a list that are empty.
const MOST_EMPTY: u32 = 1 << 16;

/// What comes next of some data.
pub(super) enum Piece {
    /// Bytes that follow those before.
    Bytes,
    /// So many bytes are lost (0 if that is not known), with what is wrong and how many bytes of the
    /// file that takes.
    Lost {
        bytes: u64,
        problem: Error,
        in_file: u64,
    },
    /// The file ends within a block.
    CutOff(Error),
    End,
}

/// The pieces of some data, in order.
#[derive(Default)]
pub(super) struct Pieces {
    links: VecDeque<u64>,
    next_list: u64,
    /// The rest of a plain block: place and length.
    rest: (u64, u64),
    is_cut_off: bool,
    empty: u32,
    /// Bytes of the blocks so far: more than the file has are a circle of links.
    taken: u64,
}

impl Pieces {
    /// Creates the pieces of the data that a link points to.
    pub(super) fn of(link: u64) -> Self {
        Self {
            links: VecDeque::from([link]),
            ..Self::default()
        }
    }

    /// Reads the next piece into `bytes`.
    ///
    /// # Errors
    /// Returns an error of the disk.
    pub(super) fn next(&mut self, file: &mut MdfFile, bytes: &mut Vec<u8>) -> Result<Piece> {
        loop {
            let (at, left) = self.rest;
            if left > 0 {
                return self.read_rest(file, at, left, bytes);
            }
            let Some(link) = self.next_link() else {
                return Ok(Piece::End);
            };
            let block = match file.block(link) {
                Ok(block) => block,
                Err(problem @ Error::Io { .. }) => return Err(problem),
                Err(problem) if link >= file.length() => return Ok(Piece::CutOff(problem)),
                Err(problem) => {
                    return Ok(Piece::Lost {
                        bytes: 0,
                        problem,
                        in_file: HEADER_BYTES,
                    });
                }
            };
            self.taken = self.taken.saturating_add(HEADER_BYTES);
            if matches!(&block.id, b"##DT" | b"##SD" | b"##DV" | b"##DZ") {
                let in_file = file.length().saturating_sub(link);
                self.taken = self.taken.saturating_add(block.length.min(in_file));
            }
            if self.taken > 2 * file.length() {
                return Err(file.error("more data blocks than the file has", "each of them once"));
            }
            match &block.id {
                b"##DT" | b"##SD" | b"##DV" => self.plain(file, &block),
                b"##DZ" => {
                    let piece = unpack(file, &block, bytes)?;
                    if matches!(piece, Piece::CutOff(_)) && !bytes.is_empty() {
                        self.is_cut_off = true;
                        return Ok(Piece::Bytes);
                    }
                    return Ok(piece);
                }
                b"##HL" => self.next_list = block.link(0),
                b"##DL" => {
                    self.next_list = block.link(0);
                    self.links.extend(block.links.iter().skip(1));
                }
                _ => {}
            }
            self.empty += 1;
            if self.empty > MOST_EMPTY {
                return Err(file.error("too many blocks without data", "blocks with data"));
            }
        }
    }

    fn next_link(&mut self) -> Option<u64> {
        loop {
            match self.links.pop_front() {
                Some(0) => {}
                Some(link) => return Some(link),
                None if self.next_list == 0 => return None,
                None => self.links.push_back(std::mem::take(&mut self.next_list)),
            }
        }
    }

    fn plain(&mut self, file: &MdfFile, block: &Block) {
        let (at, length) = (block.data_at(), block.data_length());
        let in_file = file.length().saturating_sub(at);
        let is_last = self.next_list == 0 && self.links.is_empty();
        let is_open = length == 0 && is_last && file.has_open_end();
        self.is_cut_off = !is_open && length > in_file;
        self.rest = (
            at,
            if is_open {
                in_file
            } else {
                length.min(in_file)
            },
        );
    }

    fn read_rest(
        &mut self,
        file: &mut MdfFile,
        at: u64,
        left: u64,
        bytes: &mut Vec<u8>,
    ) -> Result<Piece> {
        self.empty = 0;
        let count = left.min(STEP_BYTES);
        file.read(at, count, bytes)?;
        let read = bytes.len() as u64;
        self.rest = (at + read, if read < count { 0 } else { left - read });
        Ok(Piece::Bytes)
    }

    /// Returns the error of a plain block that the end of the file cut off, once.
    pub(super) fn take_cut_off(&mut self, file: &MdfFile) -> Option<Error> {
        let is_cut_off = std::mem::take(&mut self.is_cut_off);
        is_cut_off.then(|| file.error("the log is cut off", "a whole data block"))
    }
}

/// Unpacks a compressed block (DZ); of one that is cut off, what there is.
fn unpack(file: &mut MdfFile, block: &Block, bytes: &mut Vec<u8>) -> Result<Piece> {
    let mut packed = Vec::new();
    bytes.clear();
    let data_length = block.data_length();
    let count = data_length.min(MOST_BYTES + PACKED_HEADER_BYTES);
    file.read(block.data_at(), count, &mut packed)?;
    let is_whole = packed.len() as u64 == data_length;
    let in_file = HEADER_BYTES + packed.len() as u64;
    let lost = |bytes, problem| {
        Ok(Piece::Lost {
            bytes,
            problem,
            in_file,
        })
    };
    let (Some(kind), Some(columns), Some(length)) =
        (packed.get(2), u32_at(&packed, 4), u64_at(&packed, 8))
    else {
        let problem = file.error("a compressed block without header", "at least 24 bytes");
        return if is_whole {
            lost(0, problem)
        } else {
            Ok(Piece::CutOff(problem))
        };
    };
    if length > MOST_BYTES || data_length > MOST_BYTES + PACKED_HEADER_BYTES {
        let problem = format!("a compressed block of {length} bytes");
        let expected = format!("at most {MOST_BYTES}");
        return lost(length, file.error(&problem, &expected));
    }
    // Of two methods with the same packing, the second one is transposed.
    let is_transposed = kind % 2 == 1;
    let content = packed
        .get(PACKED_HEADER_BYTES as usize..)
        .unwrap_or_default();
    let unpacked = match kind {
        0 | 1 => ZlibDecoder::new(content).take(length).read_to_end(bytes),
        2 | 3 => zstd(content).and_then(|zstd| zstd.take(length).read_to_end(bytes)),
        4 | 5 => FrameDecoder::new(content).take(length).read_to_end(bytes),
        _ => {
            let problem = format!("compression method {kind}, which is not read");
            let expected = "deflate (0, 1), Zstandard (2, 3) or LZ4 (4, 5)";
            return lost(length, file.error(&problem, expected));
        }
    };
    let is_complete = unpacked.is_ok() && bytes.len() as u64 == length;
    if !is_complete {
        // What is transposed cannot be read without its end.
        if is_transposed {
            bytes.clear();
        }
        let problem = file.error("damaged compressed data", "as many bytes as the block says");
        return if is_whole {
            lost(length, problem)
        } else {
            Ok(Piece::CutOff(problem))
        };
    }
    if is_transposed {
        *bytes = untransposed(bytes, columns as usize);
    }
    Ok(Piece::Bytes)
}

/// Returns a reader of one Zstandard frame (MDF 4.3).
fn zstd(content: &[u8]) -> io::Result<impl Read> {
    let frame = StreamingDecoder::new_with_max_window_size(content, MOST_BYTES);
    frame.map_err(|e| io::Error::new(io::ErrorKind::InvalidData, e.to_string()))
}

/// Returns the records of a transposed block: it has the first bytes of all records, then the second
/// ones, and so on; what is behind the last whole record is as it was.
fn untransposed(bytes: &[u8], columns: usize) -> Vec<u8> {
    let rows = bytes.len().checked_div(columns).unwrap_or(0);
    let mut plain = bytes.to_vec();
    for (column, values) in bytes.chunks_exact(rows.max(1)).take(columns).enumerate() {
        if rows == 0 {
            break;
        }
        for (row, value) in values.iter().enumerate() {
            if let Some(place) = plain.get_mut(row * columns + column) {
                *place = *value;
            }
        }
    }
    plain
}
