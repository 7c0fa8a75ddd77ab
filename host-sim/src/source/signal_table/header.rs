//! The header of a table: which column has which signal.

use crate::error::{Error, Result};
use crate::files::marks::BYTE_ORDER_MARK;
use crate::files::nearest::nearest_in_words;
use csv::ByteRecord;
use estimator_core::Signal;
use std::path::Path;

/// The time column, in seconds from any origin.
pub(in super::super) const TIME: &str = "time_s";

/// A column of a signal.
#[derive(Clone, Copy, Debug)]
pub(super) struct SignalColumn {
    pub index: usize,
    pub signal: Signal,
}

/// What the header of a table has.
#[derive(Default)]
pub(super) struct HeaderColumns {
    pub time: usize,
    pub columns: Vec<SignalColumn>,
    /// Columns that are not ours.
    pub ignored: Vec<String>,
}

/// Finds the columns of the time and the signals.
pub(super) fn columns_of(path: &Path, line: u64, header: &ByteRecord) -> Result<HeaderColumns> {
    let mut time_column = None;
    let mut header_columns = HeaderColumns::default();
    for (index, name) in header.iter().enumerate() {
        let name = name.strip_prefix(BYTE_ORDER_MARK).unwrap_or(name);
        let name = String::from_utf8_lossy(name);
        let is_twice = if name == TIME {
            time_column.replace(index).is_some()
        } else {
            let Some(signal) = Signal::from_column(&name) else {
                header_columns.ignored.push(name.into_owned());
                continue;
            };
            let columns = &mut header_columns.columns;
            let is_known = columns.iter().any(|column| column.signal == signal);
            columns.push(SignalColumn { index, signal });
            is_known
        };
        if is_twice {
            return Err(Error::line(
                path,
                line,
                format!("column `{name}` is repeated"),
                "each column once",
            ));
        }
    }
    header_columns.time = time_column
        .ok_or_else(|| Error::line(path, line, "no column time_s", "time_s in the header"))?;
    if header_columns.columns.is_empty() {
        let known = Signal::ALL.iter().map(|signal| signal.column());
        let first = header_columns.ignored.first().map_or("", String::as_str);
        let alike = nearest_in_words(first, known);
        return Err(Error::line(
            path,
            line,
            "no column with a signal",
            format!("any that `roadgrade columns` lists, such as {alike}"),
        ));
    }
    header_columns.columns.sort_by_key(|column| column.signal);
    Ok(header_columns)
}
