//! The records of one group, with their invalidation bits.

use super::catalog::{DataGroup, Group};
use super::channel::Record;
use crate::error::Result;
use crate::source::damage::DamageCheck;
use crate::source::mdf::mdf_file::MdfFile;
use crate::source::mdf::records::{Records, Step};

/// Reader of the records of a group.
pub(super) struct Source {
    records: Records,
    /// The number of the group in its data group.
    id: u64,
    has_ids: bool,
    /// Records of the group so far, where it is not alone in its data group.
    count: u64,
    is_count_lost: bool,
    length: usize,
    /// Invalidation bits in blocks of their own.
    marks: Option<Marks>,
}

struct Marks {
    records: Records,
    bytes: usize,
}

impl Source {
    pub(super) fn new(data: &DataGroup, group: &Group) -> Self {
        let bytes = group.head.invalidation_bytes as usize;
        let marks = (data.is_columns && bytes > 0).then(|| Marks {
            records: Records::of_invalidation(data.link, bytes),
            bytes,
        });
        Self {
            records: Records::new(data.link, data.id_bytes, data.sizes.clone()),
            id: group.head.id,
            has_ids: data.id_bytes > 0,
            count: 0,
            is_count_lost: false,
            length: 0,
            marks,
        }
    }

    /// Goes to the next record of the group. Returns false at the end.
    ///
    /// # Errors
    /// Returns an error of the disk, and what `damage` does not allow.
    pub(super) fn advance(&mut self, file: &mut MdfFile, damage: &mut DamageCheck) -> Result<bool> {
        loop {
            match self.records.next(file, damage)? {
                Step::Record { id, length } if id == self.id || !self.has_ids => {
                    self.length = length;
                    self.count += 1;
                    break;
                }
                Step::Record { .. } => {}
                Step::Lost => self.is_count_lost = true,
                Step::End => return Ok(false),
            }
        }
        let index = self.index();
        if let Some(marks) = &mut self.marks
            && let Some(index) = index
        {
            // Marks that are lost mark nothing.
            while marks.records.index().is_none_or(|at| at < index) {
                if !matches!(marks.records.next(file, damage)?, Step::Record { .. }) {
                    break;
                }
            }
        }
        Ok(true)
    }

    /// Goes to the record with this number. Returns false if it is lost, or at the end.
    ///
    /// # Errors
    /// As [`advance`](Self::advance).
    pub(super) fn seek(
        &mut self,
        index: u64,
        file: &mut MdfFile,
        damage: &mut DamageCheck,
    ) -> Result<bool> {
        while self.count == 0 || self.index().is_some_and(|at| at < index) {
            if !self.advance(file, damage)? {
                return Ok(false);
            }
        }
        Ok(self.index() == Some(index))
    }

    /// Returns the number of the newest record; `None` if records before it are lost, nobody knows
    /// how many.
    pub(super) fn index(&self) -> Option<u64> {
        if self.has_ids {
            return (!self.is_count_lost).then(|| self.count.saturating_sub(1));
        }
        self.records.index()
    }

    /// Returns the newest record.
    pub(super) fn record(&self) -> Record<'_> {
        let bytes = self.records.record(self.length);
        let index = self.index();
        let marks = match &self.marks {
            None => bytes,
            Some(marks) if marks.records.index() == index => marks.records.record(marks.bytes),
            Some(_) => &[],
        };
        Record {
            bytes,
            marks,
            index,
        }
    }
}
