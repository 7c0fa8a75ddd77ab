//! Chains of blocks, each to its end or to what is damaged.

use super::text::text;
use crate::error::{Error, Result};
use crate::source::damage::DamageCheck;
use crate::source::mdf::conversion::Conversions;
use crate::source::mdf::mdf_file::{Block, HEADER_BYTES, MdfFile};
use std::collections::HashSet;

/// The reading of the blocks.
pub(super) struct Scan<'a> {
    pub file: &'a mut MdfFile,
    pub damage: &'a mut DamageCheck,
    seen: HashSet<u64>,
    pub conversions: Conversions,
    pub channels: usize,
}

impl<'a> Scan<'a> {
    pub(super) fn new(file: &'a mut MdfFile, damage: &'a mut DamageCheck) -> Self {
        Self {
            file,
            damage,
            seen: HashSet::new(),
            conversions: Conversions::default(),
            channels: 0,
        }
    }

    /// Reads a block of a chain; `None` where the chain ends, or is damaged.
    pub(super) fn block(&mut self, at: u64, id: &[u8; 4]) -> Result<Option<Block>> {
        if at == 0 {
            return Ok(None);
        }
        if !self.seen.insert(at) {
            let problem = self.file.error("a circle of links", "each block once");
            self.damage.block(problem, HEADER_BYTES)?;
            return Ok(None);
        }
        let block = self.file.described(at, id);
        self.unless_damaged(block)
    }

    /// Leaves out what is damaged.
    pub(super) fn unless_damaged<T>(&mut self, read: Result<T>) -> Result<Option<T>> {
        match read {
            Ok(read) => Ok(Some(read)),
            Err(problem @ Error::Io { .. }) => Err(problem),
            Err(problem) => {
                self.damage.block(problem, HEADER_BYTES)?;
                Ok(None)
            }
        }
    }

    /// Reads a name or a unit; empty if it is damaged.
    pub(super) fn text(&mut self, link: u64) -> Result<String> {
        let read = text(self.file, link);
        Ok(self.unless_damaged(read)?.unwrap_or_default())
    }
}
