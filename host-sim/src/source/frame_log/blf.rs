//! Vector's binary format (BLF).
//!
//! A file header, then objects. Most objects are containers: compressed pieces of a stream of
//! objects, which may begin in one container and end in the next. All numbers are little-endian.
//! Times are those since the start of the measurement.

use super::blf_container::Containers;
use super::blf_object::{Recorded, recorded};
use super::frame_reader::{FrameReader, LogNotes, LoggedFrame};
use crate::error::{Error, Result};
use crate::source::log_file::LogFile;
use crate::source::packing::Joint;

/// Reader of the frames of a BLF file. A file that is cut off ends there.
pub(super) struct BlfReader {
    containers: Containers,
    notes: LogNotes,
}

impl BlfReader {
    pub(super) fn boxed(file: LogFile, is_strict: bool) -> Box<dyn FrameReader> {
        file.join(Joint::Bytes);
        Box::new(Self {
            containers: Containers::new(file),
            notes: LogNotes::new(is_strict),
        })
    }
}

impl FrameReader for BlfReader {
    fn next_logged(&mut self) -> Result<Option<LoggedFrame>> {
        while let Some(object) = self.containers.next_object(&mut self.notes.damage)? {
            match recorded(self.containers.bytes(object)) {
                Ok(Recorded::Frame {
                    micros,
                    channel,
                    frame,
                }) => {
                    let interface = self.notes.interfaces.channel(channel.into());
                    return Ok(Some(self.notes.frame(micros, interface, frame)));
                }
                Ok(Recorded::FlexibleRate) => self.notes.skipped.can_fd += 1,
                Ok(Recorded::BusError) => self.notes.skipped.bus_errors += 1,
                Ok(Recorded::Other) => {}
                Err(problem) => {
                    let error = self.error(problem.what, problem.expected);
                    self.notes.damage.line(error, self.notes.frames)?;
                }
            }
        }
        self.notes.origin_us = self.containers.origin_us();
        Ok(None)
    }

    fn error(&self, problem: &str, expected: &str) -> Error {
        self.containers.error(problem, expected)
    }

    fn file(&self) -> &LogFile {
        self.containers.file()
    }

    fn notes(&self) -> &LogNotes {
        &self.notes
    }

    fn notes_mut(&mut self) -> &mut LogNotes {
        &mut self.notes
    }
}
