//! Compressed blocks.

use super::mdf_file::{Block, HEADER_BYTES, MdfFile, u32_at, u64_at};
use super::piece::Piece;
use crate::error::Result;
use flate2::read::ZlibDecoder;
use lz4_flex::frame::FrameDecoder;
use ruzstd::decoding::StreamingDecoder;
use std::io::{self, Read};

/// Largest compressed block, bytes, packed or unpacked. Writers use up to 4 MiB.
const MOST_BYTES: u64 = 16 << 20;
/// Bytes of a compressed block before its content.
const PACKED_HEADER_BYTES: u64 = 24;

/// Unpacks a compressed block (DZ); of one that is cut off, what there is.
pub(super) fn unpack(file: &mut MdfFile, block: &Block, bytes: &mut Vec<u8>) -> Result<Piece> {
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
