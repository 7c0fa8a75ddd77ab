//! The file of a road memory during a live drive: a computer in a vehicle may lose its power at any time.

use crate::error::Result;
use crate::files::flash_image::{self, RoadMemoryFile};
use std::path::Path;
use std::time::{Duration, Instant as Monotonic};

/// Time from one writing to the next.
const PERIOD: Duration = Duration::from_secs(60);

/// When the file was written, and what it has.
#[derive(Debug)]
pub struct SavedMemory<'a> {
    path: &'a Path,
    due: Monotonic,
    /// Writes of the memory that the file has.
    writes: u32,
}

impl<'a> SavedMemory<'a> {
    /// Begins a drive.
    #[must_use]
    pub fn new(path: &'a Path) -> Self {
        Self {
            path,
            due: Monotonic::now() + PERIOD,
            writes: 0,
        }
    }

    /// Writes the file if a minute is over and the memory has written something since.
    ///
    /// # Errors
    /// Returns the error of the file system.
    pub fn save_if_due(&mut self, memory: &RoadMemoryFile) -> Result<()> {
        let now = Monotonic::now();
        let writes = memory.counters().writes;
        if now < self.due || writes == self.writes {
            return Ok(());
        }
        (self.due, self.writes) = (now + PERIOD, writes);
        flash_image::stage(self.path, memory)?.commit()
    }
}
