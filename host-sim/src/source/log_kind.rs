//! Kinds of log files.

use super::log_file::is_standard_input;
use crate::error::{Error, Result};
use crate::files::log_format::LogFormat;
use std::fmt;
use std::path::Path;

/// The kind of a log.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LogKind {
    /// Frames of a bus.
    Frames(LogFormat),
    /// Decoded signals, in ASAM's measurement data format.
    MdfSignals,
    /// A signal table.
    SignalTable,
}

impl fmt::Display for LogKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Frames(format) => format.fmt(f),
            Self::MdfSignals => f.write_str("ASAM MDF 4 signals"),
            Self::SignalTable => f.write_str("signal table"),
        }
    }
}

/// Returns the kind of a log whose content does not tell, by its name: `.csv` and `.csv.gz` are
/// signal tables, all others candump logs.
///
/// # Errors
/// Returns an error if the file does not exist.
pub fn kind_of(path: &Path) -> Result<LogKind> {
    if is_standard_input(path) {
        return Ok(LogKind::Frames(LogFormat::Candump));
    }
    if path.metadata().map_err(Error::io(path))?.is_dir() {
        return Err(Error::content(path, "is a folder; expected a log file"));
    }
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    let name = name.to_ascii_lowercase();
    let name = name.strip_suffix(".gz").unwrap_or(&name);
    let name = name.strip_suffix(".zst").unwrap_or(name);
    Ok(if name.ends_with(".csv") {
        LogKind::SignalTable
    } else {
        LogKind::Frames(LogFormat::Candump)
    })
}
