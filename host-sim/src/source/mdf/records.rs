//! The records of a data group, as a stream of bytes.

use super::mdf_file::{MdfFile, number};
use super::piece::Piece;
use super::pieces::Pieces;
use crate::error::Result;
use crate::source::damage::DamageCheck;
use std::collections::BTreeMap;

/// Largest record of variable length, bytes.
const MOST_RECORD_BYTES: usize = 1 << 20;
/// Bytes of the length of a record of variable length.
const LENGTH_BYTES: usize = 4;

/// The size of the records of a channel group, bytes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::source) enum Size {
    Fixed(usize),
    /// Each record begins with its length.
    Variable,
}

/// The records of a data group.
pub(in crate::source) struct Records {
    pieces: Pieces,
    piece: Vec<u8>,
    /// Bytes read, of which `used` were handed out.
    bytes: Vec<u8>,
    used: usize,
    /// Bytes of the number of the group in front of each record: 0, 1, 2, 4 or 8.
    id_bytes: usize,
    sizes: BTreeMap<u64, Size>,
    /// Bytes to leave out, of a record that is partly lost.
    to_skip: u64,
    /// Bytes of the data so far, with those that are lost.
    offset: u64,
    /// True if it is not known how many bytes are lost.
    is_lost: bool,
}

/// One step through the records.
pub(in crate::source) enum Step {
    /// A record of the group with this number; its bytes are `Records::record`.
    Record {
        id: u64,
        length: usize,
    },
    /// Records are lost.
    Lost,
    End,
}

impl Records {
    pub(in crate::source) fn new(link: u64, id_bytes: usize, sizes: BTreeMap<u64, Size>) -> Self {
        Self {
            pieces: Pieces::of(link),
            piece: Vec::new(),
            bytes: Vec::new(),
            used: 0,
            id_bytes,
            sizes,
            to_skip: 0,
            offset: 0,
            is_lost: false,
        }
    }

    /// Creates the invalidation bits of the records of a column, which stand in blocks of their own.
    pub(in crate::source) fn of_invalidation(link: u64, bytes: usize) -> Self {
        Self {
            pieces: Pieces::of_invalidation(link, bytes as u64),
            ..Self::new(0, 0, BTreeMap::from([(0, Size::Fixed(bytes))]))
        }
    }

    /// Returns the number of the newest record of a group that is alone in its data group; `None`
    /// if an unknown number of records before it is lost.
    pub(in crate::source) fn index(&self) -> Option<u64> {
        let Some(Size::Fixed(size)) = self.sizes.values().next() else {
            return None;
        };
        let rest = self.bytes.len().saturating_sub(self.used) as u64;
        let end = self.offset.saturating_sub(rest);
        let index = end.checked_div(*size as u64)?.checked_sub(1)?;
        (!self.is_lost && self.id_bytes == 0).then_some(index)
    }

    /// Returns the bytes of the newest record, without the number of its group.
    pub(in crate::source) fn record(&self, length: usize) -> &[u8] {
        let end = self.used;
        let start = end.saturating_sub(length);
        self.bytes.get(start..end).unwrap_or_default()
    }

    /// Goes to the next record.
    ///
    /// # Errors
    /// Returns an error of the disk, and what `damage` does not allow.
    pub(in crate::source) fn next(
        &mut self,
        file: &mut MdfFile,
        damage: &mut DamageCheck,
    ) -> Result<Step> {
        loop {
            let rest = self.bytes.get(self.used..).unwrap_or_default();
            match self.measure(rest) {
                Measured::Whole { id, head, length } => {
                    self.used += head + length;
                    return Ok(Step::Record { id, length });
                }
                Measured::Unknown => {
                    let lost = rest.len() as u64;
                    let error =
                        file.error("a record of an unknown group", "one of this data group");
                    damage.block(error, lost)?;
                    self.used = self.bytes.len();
                    return Ok(Step::Lost);
                }
                Measured::Partial => {}
            }
            self.bytes.drain(..self.used);
            self.used = 0;
            match self.pieces.next(file, &mut self.piece)? {
                Piece::Bytes => self.append(),
                Piece::Lost {
                    bytes,
                    problem,
                    in_file,
                } => {
                    damage.block(problem, in_file)?;
                    self.lose(bytes);
                    return Ok(Step::Lost);
                }
                Piece::CutOff(problem) => damage.cut_off(problem)?,
                Piece::End => {
                    if let Some(problem) = self.pieces.take_cut_off(file) {
                        damage.cut_off(problem)?;
                    } else if !self.bytes.is_empty() {
                        let problem = file.error("the log is cut off", "a whole record");
                        damage.cut_off(problem)?;
                    }
                    self.bytes.clear();
                    return Ok(Step::End);
                }
            }
        }
    }

    fn append(&mut self) {
        let skipped = self.to_skip.min(self.piece.len() as u64);
        self.to_skip -= skipped;
        let piece = self.piece.get(skipped as usize..).unwrap_or_default();
        self.bytes.extend_from_slice(piece);
        self.offset = self.offset.saturating_add(self.piece.len() as u64);
    }

    /// Leaves out bytes that are lost, and the rest of the record in which they end. Where records
    /// differ in length, the next block must begin with one.
    fn lose(&mut self, lost: u64) {
        self.bytes.clear();
        self.is_lost |= lost == 0;
        self.offset = self.offset.saturating_add(lost);
        let mut sizes = self.sizes.values();
        if let Some(Size::Fixed(size)) = sizes.next()
            && sizes.all(|other| *other == Size::Fixed(*size))
        {
            let size = (size + self.id_bytes) as u64;
            let over = self.offset.checked_rem(size).unwrap_or(0);
            self.to_skip = if over == 0 { 0 } else { size - over };
        }
    }

    /// Measures the record at the head of some bytes.
    fn measure(&self, bytes: &[u8]) -> Measured {
        let Some(id_bytes) = bytes.get(..self.id_bytes) else {
            return Measured::Partial;
        };
        if bytes.is_empty() {
            return Measured::Partial;
        }
        let fold = |sum: u64, byte: &u8| (sum << 8) | u64::from(*byte);
        let id = id_bytes.iter().rev().fold(0, fold);
        let size = if self.id_bytes == 0 {
            self.sizes.iter().next()
        } else {
            self.sizes.get_key_value(&id)
        };
        let (id, head, length) = match size {
            Some((id, Size::Fixed(length))) => (*id, self.id_bytes, *length),
            Some((id, Size::Variable)) => {
                let Some(length) = number(bytes, self.id_bytes).map(u32::from_le_bytes) else {
                    return Measured::Partial;
                };
                if length as usize > MOST_RECORD_BYTES {
                    return Measured::Unknown;
                }
                (*id, self.id_bytes + LENGTH_BYTES, length as usize)
            }
            None => return Measured::Unknown,
        };
        if head + length == 0 {
            return Measured::Unknown;
        }
        if bytes.len() < head + length {
            return Measured::Partial;
        }
        Measured::Whole { id, head, length }
    }
}

enum Measured {
    Whole { id: u64, head: usize, length: usize },
    Partial,
    Unknown,
}
