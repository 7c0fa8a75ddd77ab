//! What a file is, by its first bytes: for messages about files in the wrong place.

use super::log_format::{LogFormat, format_of};
use super::unpacked::{self, ROAD_ENDINGS};
use crate::error::Error;
use estimator_core::{Signal, Tuning};
use std::fmt;
use std::fs::File;
use std::io::Read;
use std::path::Path;

/// Bytes that are looked at.
const HEAD_BYTES: u64 = 16 << 10;
/// First bytes of a Parquet file.
pub const PARQUET_MAGIC: &[u8] = b"PAR1";

/// A kind of file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// Frames of a bus.
    FrameLog(LogFormat),
    /// A table of signals.
    SignalTable,
    /// Cells of a drive.
    Run,
    /// Fused cells.
    Map,
    /// Points of a road.
    Road,
    /// True grade of a drive.
    Truth,
    /// Sums behind a map.
    Sums,
    /// A mission of the ZTBus data set.
    Mission,
    /// Vehicle parameters.
    Vehicle,
    /// True parameters and noise.
    Oracle,
    /// What to simulate.
    Scenario,
    /// Parameters of the estimator.
    Tuning,
    /// Fused cells in the form that the vehicle reads.
    PackedMap,
    /// Roads that a vehicle has driven.
    RoadMemory,
    /// An extract of OpenStreetMap.
    OsmPbf,
    /// The same as text.
    OsmXml,
    /// Tracks.
    Gpx,
    /// Shapes of a map.
    Kml,
    /// JSON of any content.
    Json,
    /// Parquet of any content.
    Parquet,
}

impl fmt::Display for Kind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::FrameLog(format @ (LogFormat::Mdf | LogFormat::Actisense)) => {
                return write!(f, "an {format}");
            }
            Self::FrameLog(format) => return write!(f, "a {format}"),
            Self::SignalTable => "a signal table",
            Self::Run => "a run (of `roadgrade estimate`)",
            Self::Map => "a map (of `roadgrade fuse`)",
            Self::Road => "a road",
            Self::Truth => "a truth file",
            Self::Sums => "the sums of a map (`roadgrade fuse --store`)",
            Self::Mission => "a ZTBus mission (for `roadgrade import ztbus`)",
            Self::Vehicle => "a vehicle file",
            Self::Oracle => "an oracle file",
            Self::Scenario => "a scenario file",
            Self::Tuning => "a tuning file",
            Self::PackedMap => "a packed map (of `roadgrade pack`)",
            Self::RoadMemory => "a road memory (of `roadgrade estimate --memory`)",
            Self::OsmPbf => "an OpenStreetMap extract (.osm.pbf)",
            Self::OsmXml => "OpenStreetMap XML",
            Self::Gpx => "a GPX file",
            Self::Kml => "a KML file",
            Self::Json => "a JSON file",
            Self::Parquet => "a Parquet file",
        })
    }
}

/// Returns the kind of a file, if its beginning tells.
#[must_use]
pub fn of(path: &Path) -> Option<Kind> {
    // Opening a pipe may wait for ever.
    if !path.is_file() {
        return None;
    }
    let head = head(path).ok()?;
    if head.starts_with(&estimator_core::roadmap::format::MAGIC) {
        return Some(Kind::PackedMap);
    }
    if head.starts_with(&estimator_core::roadmap::memory::MAGIC) {
        return Some(Kind::RoadMemory);
    }
    if head.starts_with(PARQUET_MAGIC) {
        return Some(Kind::Parquet);
    }
    // The length and the type of the first block.
    if head
        .get(4..15)
        .is_some_and(|name| name == b"\x0a\x09OSMHeader")
    {
        return Some(Kind::OsmPbf);
    }
    if let Some(format) = format_of(&head) {
        return Some(Kind::FrameLog(format));
    }
    // A byte order mark means UTF-16.
    let (text, ..) = encoding_rs::UTF_8.decode(&head);
    let text = text.trim_start_matches('\u{feff}').trim_start();
    // Its name may have the prefix of a namespace.
    let has_element = |name: &str| {
        let names = [format!("<{name}"), format!(":{name}")];
        text.starts_with('<') && names.iter().any(|name| text.contains(name))
    };
    if text.starts_with("# roadgrade sums") {
        Some(Kind::Sums)
    } else if has_element("osm") {
        Some(Kind::OsmXml)
    } else if has_element("gpx") {
        Some(Kind::Gpx)
    } else if has_element("kml") {
        Some(Kind::Kml)
    } else if text.starts_with(['{', '\u{1e}']) {
        Some(Kind::Json)
    } else {
        of_tables(text).or_else(|| of_columns(text.lines().next()?))
    }
}

/// Returns an error if the file is clearly of another kind than these. The first one names them in
/// the message.
///
/// # Errors
/// Names both kinds.
pub(crate) fn refuse_other(path: &Path, expected: &[Kind]) -> Result<(), Error> {
    match (of(path), expected) {
        (Some(found), [first, ..]) if !expected.contains(&found) => Err(Error::content(
            path,
            format!("is {found}; expected {first}"),
        )),
        _ => Ok(()),
    }
}

/// Returns the error, or one that says that the file is of another kind than expected. `expected`
/// are the kinds that the reader takes; the first names them in the message.
pub(crate) fn explained(error: Error, path: &Path, expected: &[Kind]) -> Error {
    if matches!(error, Error::Io { .. } | Error::Usage(_)) {
        return error;
    }
    refuse_other(path, expected).err().unwrap_or(error)
}

/// Returns the first bytes, those inside of a packed file.
fn head(path: &Path) -> std::io::Result<Vec<u8>> {
    let mut head = Vec::new();
    if let Ok(file) = unpacked::open(path, ROAD_ENDINGS) {
        // What is before the damage of a packed file is enough.
        let _ = file.take(HEAD_BYTES).read_to_end(&mut head);
    }
    if head.is_empty() {
        File::open(path)?.take(HEAD_BYTES).read_to_end(&mut head)?;
    }
    Ok(head)
}

/// Returns the kind of a TOML file by its tables.
fn of_tables(text: &str) -> Option<Kind> {
    let has = |table: &str| text.lines().any(|line| line.trim() == table);
    let mut groups = Tuning::PARAMETERS.iter().map(|parameter| parameter.group);
    if has("[[runs]]") {
        Some(Kind::Scenario)
    } else if has("[vehicle]") && has("[noise]") {
        Some(Kind::Oracle)
    } else if has("[vehicle]") {
        Some(Kind::Vehicle)
    } else if groups.any(|group| has(&format!("[{group}]"))) {
        Some(Kind::Tuning)
    } else {
        None
    }
}

/// Returns the kind of a table by its header.
fn of_columns(header: &str) -> Option<Kind> {
    let columns: Vec<&str> = header.split(',').map(str::trim).collect();
    let has = |column: &str| columns.contains(&column);
    let is_signal = |column: &&str| Signal::from_column(column).is_some();
    if has("time_iso") {
        Some(Kind::Mission)
    } else if has("grade_sum") {
        Some(Kind::Sums)
    } else if has("distance_m") && has("runs") {
        Some(Kind::Map)
    } else if has("distance_m") && has("live_grade_percent") {
        Some(Kind::Run)
    } else if has("distance_m") && has("shifting") {
        Some(Kind::Truth)
    } else if has("distance_m") && has("latitude_deg") && !has("time_s") {
        Some(Kind::Road)
    } else if has("time_s") && columns.iter().any(is_signal) {
        Some(Kind::SignalTable)
    } else {
        None
    }
}
