//! The signal data of a channel: values of variable length, found by their offset.

use crate::error::Result;
use crate::source::damage::DamageCheck;
use crate::source::mdf::mdf_file::{MdfFile, number};
use crate::source::mdf::piece::Piece;
use crate::source::mdf::pieces::Pieces;

/// Bytes of the length in front of each value.
const LENGTH_BYTES: usize = 4;
/// Longest value, bytes: CAN XL has 2048.
const MOST_BYTES: usize = 4096;

/// Reader of the values, whose offsets grow.
pub(super) struct SignalData {
    pieces: Pieces,
    piece: Vec<u8>,
    bytes: Vec<u8>,
    /// Offset of the first of these bytes.
    start: u64,
    is_over: bool,
}

impl SignalData {
    pub(super) fn new(link: u64) -> Self {
        Self {
            pieces: Pieces::of(link),
            piece: Vec::new(),
            bytes: Vec::new(),
            start: 0,
            is_over: false,
        }
    }

    /// Returns the value at an offset; `None` if it is lost.
    pub(super) fn value(
        &mut self,
        offset: u64,
        file: &mut MdfFile,
        damage: &mut DamageCheck,
    ) -> Result<Option<&[u8]>> {
        self.read_to(offset, LENGTH_BYTES, file, damage)?;
        let Some(at) = offset.checked_sub(self.start).map(|at| at as usize) else {
            return Ok(None);
        };
        let Some(length) = number(&self.bytes, at).map(u32::from_le_bytes) else {
            return Ok(None);
        };
        let length = length as usize;
        if length > MOST_BYTES {
            return Ok(None);
        }
        self.read_to(offset, LENGTH_BYTES + length, file, damage)?;
        let Some(at) = offset.checked_sub(self.start).map(|at| at as usize) else {
            return Ok(None);
        };
        let value = self.bytes.get(at + LENGTH_BYTES..);
        Ok(value.and_then(|value| value.get(..length)))
    }

    /// Reads until so many bytes from an offset are there, or the data are over. Drops what is before.
    fn read_to(
        &mut self,
        offset: u64,
        count: usize,
        file: &mut MdfFile,
        damage: &mut DamageCheck,
    ) -> Result<()> {
        let end = offset.saturating_add(count as u64);
        while !self.is_over && self.start.saturating_add(self.bytes.len() as u64) < end {
            let before = offset.saturating_sub(self.start);
            let before = before.min(self.bytes.len() as u64);
            self.bytes.drain(..before as usize);
            self.start += before;
            match self.pieces.next(file, &mut self.piece)? {
                Piece::Bytes => self.bytes.extend_from_slice(&self.piece),
                Piece::Lost {
                    bytes,
                    problem,
                    in_file,
                } => {
                    damage.block(problem, in_file)?;
                    let after = self.start.saturating_add(self.bytes.len() as u64);
                    self.start = after.saturating_add(bytes);
                    self.bytes.clear();
                }
                Piece::CutOff(problem) => damage.cut_off(problem)?,
                Piece::End => {
                    self.is_over = true;
                    if let Some(problem) = self.pieces.take_cut_off(file) {
                        damage.cut_off(problem)?;
                    }
                }
            }
        }
        Ok(())
    }
}
