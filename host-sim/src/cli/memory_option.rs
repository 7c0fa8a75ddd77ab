//! The road memory of a vehicle, as an option of the commands that drive.

use crate::error::{Result, on_one_line};
use crate::files::flash_image::{self, RoadMemoryFile};
use crate::files::output::Staged;
use crate::recorder::LongRun;
use crate::terminal::print::alert;
use estimator_core::roadmap::memory::Opened;
use std::path::{Path, PathBuf};

/// `--memory` and its size.
#[derive(Debug, clap::Args)]
pub struct MemoryOption {
    /// Road memory of the vehicle: the roads that it has driven. The live grade is combined with what
    /// it knows, and it learns this drive. Read before the drive, written after it.
    #[arg(long, value_name = "FILE", hide_short_help = true)]
    memory: Option<PathBuf>,
    /// Size of a new road memory, bytes: 32768 to 16777216, a multiple of 4096 [default: 1048576].
    #[arg(long, value_name = "N", requires = "memory", value_parser = flash_image::parse_bytes, hide_short_help = true)]
    memory_bytes: Option<usize>,
}

impl MemoryOption {
    /// Returns its file.
    pub fn path(&self) -> Option<&Path> {
        self.memory.as_deref()
    }

    /// Opens it, and says what of it is not read.
    ///
    /// # Errors
    /// Returns the error of the file system, or says that the file is no road memory of this size.
    pub fn open(&self) -> Result<Option<RoadMemoryFile>> {
        let memory = self.path().map(|path| {
            let memory = flash_image::open(path, self.memory_bytes)?;
            note_opened(path, memory.opened());
            Ok(memory)
        });
        memory.transpose()
    }

    /// Writes what it knows after a drive to a file that appears when it is committed.
    ///
    /// # Errors
    /// Returns the error of the file system.
    pub fn stage(&self, run: &LongRun) -> Result<Option<Staged>> {
        let learned = self.path().zip(run.memory.as_ref());
        let staged = learned.map(|(path, learned)| flash_image::stage(path, &learned.memory));
        staged.transpose()
    }
}

/// Says what of a road memory is not read.
fn note_opened(path: &Path, opened: &Opened) {
    let path = on_one_line(path);
    if opened.other_version > 0 {
        let count = opened.other_version;
        alert(format_args!(
            "{path}: {count} pages of another release are not read; they are kept while there is room"
        ));
    }
    if opened.damaged > 0 {
        let count = opened.damaged;
        alert(format_args!(
            "{path}: {count} damaged sectors are left out; their roads are learned again"
        ));
    }
}
