//! Signal tables, plain or gzip: rows in the order of time, or an error that names the file.

use crate::as_file;
use host_sim::source::signal_table::SignalTableReader;

/// Checks an input.
pub fn signal_table(bytes: &[u8]) {
    as_file(".csv", bytes, |path| {
        let named = |error: host_sim::error::Error| {
            assert!(error.to_string().contains(&path.display().to_string()));
        };
        let mut table = match SignalTableReader::open(path) {
            Ok(table) => table,
            Err(error) => return named(error),
        };
        let mut newest = None;
        loop {
            match table.next_row() {
                Ok(Some(row)) => {
                    assert!(newest.is_none_or(|newest| newest <= row.time));
                    newest = Some(row.time);
                    for reading in row.readings {
                        assert!(reading.value.is_available(), "{reading:?}");
                    }
                }
                Ok(None) => return,
                Err(error) => return named(error),
            }
        }
    });
}
