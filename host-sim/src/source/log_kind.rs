//! Kinds of log files.

use super::log_file::is_standard_input;
use crate::error::{Error, Result};
use std::fmt;
use std::path::Path;

/// The kind of a log.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LogKind {
    /// Frames of a bus, in either layout of candump.
    Candump,
    /// Frames of a bus, in Vector's text format.
    Asc,
    /// Frames of a bus, in PEAK's text format.
    Trc,
    /// Frames of a bus, in Vector's binary format.
    Blf,
    /// Frames of a bus, in ASAM's measurement data format.
    Mdf,
    /// Decoded signals, in ASAM's measurement data format.
    MdfSignals,
    /// Frames of a bus, in the CSV of SavvyCAN and GVRET.
    SavvyCan,
    /// Frames of a bus, in the CSV of python-can.
    PythonCan,
    /// Frames of a bus, in the CSV of the converter for a CANedge.
    CanEdge,
    /// Frames of a bus, in the CSV of the loggers CL1000, CL2000 and CL3000.
    Clx,
    /// Packets of SocketCAN, in pcap or pcapng.
    Pcap,
    /// Frames of a bus, in the text of BUSMASTER.
    Busmaster,
    /// NMEA 2000 in the text of canboat.
    Canboat,
    /// NMEA 2000 in the RAW of Yacht Devices.
    YachtDevices,
    /// NMEA 2000 in the N2K ASCII of Actisense.
    Actisense,
    /// A signal table.
    SignalTable,
}

impl fmt::Display for LogKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Candump => "candump log",
            Self::Asc => "Vector ASC log",
            Self::Trc => "PEAK TRC log",
            Self::Blf => "Vector BLF log",
            Self::Mdf => "ASAM MDF 4 log",
            Self::MdfSignals => "ASAM MDF 4 signals",
            Self::SavvyCan => "SavvyCAN log",
            Self::PythonCan => "python-can log",
            Self::CanEdge => "CANedge CSV log",
            Self::Clx => "log of a CL1000, CL2000 or CL3000",
            Self::Pcap => "packet capture",
            Self::Busmaster => "BUSMASTER log",
            Self::Canboat => "canboat log",
            Self::YachtDevices => "Yacht Devices RAW log",
            Self::Actisense => "Actisense N2K ASCII log",
            Self::SignalTable => "signal table",
        })
    }
}

/// Returns the kind of a log whose content does not tell, by its name: `.csv` and `.csv.gz` are
/// signal tables, all others candump logs.
///
/// # Errors
/// Returns an error if the file does not exist.
pub fn kind_of(path: &Path) -> Result<LogKind> {
    if is_standard_input(path) {
        return Ok(LogKind::Candump);
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
        LogKind::Candump
    })
}
