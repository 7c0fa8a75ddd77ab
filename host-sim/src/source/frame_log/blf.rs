//! Vector's binary format (BLF).
//!
//! A file header, then objects. Most objects are containers: compressed pieces of a stream of
//! objects, which may begin in one container and end in the next. All numbers are little-endian.
//! Times are those since the start of the measurement.

use super::blf_container::Containers;
use super::blf_object::{ObjectProblem, Recorded, recorded};
use super::text::no_frames;
use crate::error::{Error, Result};
use crate::source::can_frame::TimedFrame;
use crate::source::candump::Skipped;
use crate::source::log_file::LogFile;
use crate::source::time_order::{IN_ORDER, TimeOrder};
use estimator_core::Instant;

/// Reader of the frames of a BLF file. A file that is cut off ends there.
pub(super) struct BlfReader {
    containers: Containers,
    order: TimeOrder,
    frames: u64,
    skipped: Skipped,
}

impl BlfReader {
    pub(super) fn new(mut file: LogFile) -> Self {
        file.allow_cut_off();
        Self {
            containers: Containers::new(file),
            order: TimeOrder::default(),
            frames: 0,
            skipped: Skipped::default(),
        }
    }

    pub(super) fn next_frame(&mut self) -> Result<Option<TimedFrame>> {
        while let Some(object) = self.containers.next_object()? {
            let content = recorded(self.containers.bytes(object));
            match content.map_err(|problem| self.wrong_object(&problem))? {
                Recorded::Frame { micros, frame } => {
                    let time = self.order.place(Instant::from_micros(micros));
                    let time = time.map_err(|what| self.error(&what, IN_ORDER))?;
                    self.frames += 1;
                    return Ok(Some(TimedFrame { time, frame }));
                }
                Recorded::FlexibleRate => self.skipped.can_fd += 1,
                Recorded::BusError => self.skipped.bus_errors += 1,
                Recorded::Other => {}
            }
        }
        no_frames(self.file(), self.frames, self.skipped, "a Vector BLF log").map(|()| None)
    }

    pub(super) const fn skipped(&self) -> Skipped {
        self.skipped
    }

    pub(super) fn file(&self) -> &LogFile {
        self.containers.file()
    }

    fn wrong_object(&self, problem: &ObjectProblem) -> Error {
        self.error(problem.what, problem.expected)
    }

    fn error(&self, problem: &str, expected: &str) -> Error {
        self.containers.error(problem, expected)
    }
}
