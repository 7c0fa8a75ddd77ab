//! ASAM's measurement data format, version 4 (MDF): raw CAN frames as bus loggers write them.
//!
//! The file is a tree of blocks: data groups, in them channel groups, in them channels. A group whose
//! channels are `CAN_DataFrame.ID` and so on has frames (ASAM bus logging). The data
//! of a group are one block, or a list of them, plain or compressed.
//!
//! * Groups are read beside each other. Their frames are put in the order of time later.
//! * A file that its writer did not finish is read to its end.
//! * Memory does not grow with the file: a few blocks of each group.

mod data_group;
mod layout;
mod signal_data;

use super::frame_reader::{FrameReader, LogNotes, LoggedFrame};
use crate::error::{Error, Result};
use crate::source::log_file::LogFile;
use crate::source::mdf::mdf_file::MdfFile;
use data_group::{DataGroup, Found};

/// Most data groups with frames: each holds a few blocks.
const MOST_GROUPS: usize = 64;

/// A data group and its next frame.
struct Merged {
    group: DataGroup,
    next: Option<Found>,
}

/// Reader of the frames of an MDF file.
pub(super) struct MdfReader {
    file: MdfFile,
    groups: Vec<Merged>,
    is_started: bool,
    notes: LogNotes,
}

impl MdfReader {
    /// Reads the groups of a file.
    ///
    /// # Errors
    /// Returns an error of the disk, and for a file whose blocks cannot be read.
    pub(super) fn boxed(mut file: MdfFile, is_strict: bool) -> Result<Box<dyn FrameReader>> {
        let mut notes = LogNotes::new(is_strict);
        let header = file.header()?;
        notes.origin_us = file.origin_us(&header)?;
        let mut groups = Vec::new();
        let mut next = header.link(0);
        while next != 0 {
            let block = file.described(next, b"##DG")?;
            if let Some(group) = DataGroup::read(&mut file, &block)? {
                if groups.len() == MOST_GROUPS {
                    let expected = format!("at most {MOST_GROUPS}");
                    return Err(file.error("too many data groups with frames", &expected));
                }
                groups.push(Merged { group, next: None });
            }
            next = block.link(0);
        }
        if groups.is_empty() {
            let problem = "no frames of a bus and no signals in this MDF file; expected groups of \
                           CAN_DataFrame, as bus loggers write them, or channels with a time";
            return Err(Error::content(file.log().path(), problem));
        }
        Ok(Box::new(Self {
            file,
            groups,
            is_started: false,
            notes,
        }))
    }
}

impl MdfReader {
    /// Reads the first frame of each group.
    fn start(&mut self) -> Result<()> {
        for merged in &mut self.groups {
            merged.next = merged.group.next_frame(&mut self.file, &mut self.notes)?;
        }
        self.is_started = true;
        Ok(())
    }
}

impl FrameReader for MdfReader {
    fn next_logged(&mut self) -> Result<Option<LoggedFrame>> {
        if !self.is_started {
            self.start()?;
        }
        let with_frame = self
            .groups
            .iter_mut()
            .filter(|merged| merged.next.is_some());
        let first = with_frame.min_by_key(|merged| merged.next.map(|found| found.micros));
        let Some(merged) = first else {
            return Ok(None);
        };
        let Some(found) = merged.next.take() else {
            return Ok(None);
        };
        merged.next = merged.group.next_frame(&mut self.file, &mut self.notes)?;
        let interface = self.notes.interfaces.channel(found.channel);
        Ok(Some(self.notes.frame(found.micros, interface, found.frame)))
    }

    fn error(&self, problem: &str, expected: &str) -> Error {
        self.file.error(problem, expected)
    }

    fn file(&self) -> &LogFile {
        self.file.log()
    }

    fn notes(&self) -> &LogNotes {
        &self.notes
    }

    fn notes_mut(&mut self) -> &mut LogNotes {
        &mut self.notes
    }
}
