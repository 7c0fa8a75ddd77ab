//! `read_log` and `read_frames`.

use crate::reading::Reading;
use crate::table::Table;
use crate::work::in_background;
use crate::{frame_table, signal_table};
use pyo3::prelude::*;
use std::path::PathBuf;

/// Read the signals of a log: one row for each time, one column for each signal that occurs.
///
/// log: a recording in any format that `roadgrade` reads, plain, gzip or zstd, or a signal table.
/// strict: refuse a log with any damage; else up to 1 % is left out and counted.
/// interfaces: read only the frames of these interfaces.
/// ignore: names of signals to leave out.
/// dbc, signals: description of the bus and mapping of its signals, for messages that are not built in;
/// signals alone: mapping of the channels of an MDF file with decoded signals.
///
/// A value that the bus does not have at a time is null. If several senders have a signal, the first
/// one counts. `metadata["roadgrade.report"]` is what the reading found, as JSON. Raises `Error`, with
/// file and line, for a log that cannot be read, and `ValueError` for a signal that does not exist.
#[pyfunction]
#[pyo3(signature = (log, *, strict=false, interfaces=None, ignore=None, dbc=None, signals=None))]
pub fn read_log(
    py: Python<'_>,
    log: PathBuf,
    strict: bool,
    interfaces: Option<Vec<String>>,
    ignore: Option<Vec<String>>,
    dbc: Option<PathBuf>,
    signals: Option<PathBuf>,
) -> PyResult<Table> {
    let reading = Reading {
        strict,
        interfaces,
        ignore,
        dbc,
        signals,
    };
    in_background(py, move |stop| {
        signal_table::read(&log, &reading.options(stop)?)
    })
    .map(Table::new)
}

/// Read the frames of a log as they were on the bus, in the order of time.
///
/// log: a recording of a bus in any format that `roadgrade` reads, plain, gzip or zstd.
/// strict: refuse a log with any damage; else up to 1 % is left out and counted.
/// interfaces: read only the frames of these interfaces.
///
/// The columns are time_s, id, extended, remote, pgn and source (of 29-bit identifiers), and data. A
/// message that several interfaces have is read from one. `metadata["roadgrade.report"]` is what the
/// reading found, as JSON. Raises `Error`, with file and line, for a log that cannot be read, and for
/// a signal table.
#[pyfunction]
#[pyo3(signature = (log, *, strict=false, interfaces=None))]
pub fn read_frames(
    py: Python<'_>,
    log: PathBuf,
    strict: bool,
    interfaces: Option<Vec<String>>,
) -> PyResult<Table> {
    let reading = Reading {
        strict,
        interfaces,
        ..Reading::default()
    };
    in_background(py, move |stop| {
        frame_table::read(&log, &reading.options(stop)?)
    })
    .map(Table::new)
}
