//! The writer of tables.

use super::cell_value::largest_angle_deg;
use super::time_column::TIME;
use crate::error::Result;
use crate::files::output::write_whole;
use estimator_core::{Instant, Signal};
use std::io::{self, Write};
use std::path::Path;

/// Writes a table, whole or not at all: `time_s` and `columns`, and each row's values in the order
/// of `columns` (angles in degrees). `None` and non-finite values are written as empty cells.
///
/// Numbers get as many digits as needed to read them back exactly.
///
/// # Errors
/// Returns the error of the file system, or an error for a row with a wrong number of values.
pub fn write<V: AsRef<[Option<f64>]>>(
    path: &Path,
    columns: &[Signal],
    rows: impl IntoIterator<Item = (Instant, V)>,
) -> Result<()> {
    write_whole(path, |out| {
        out.write_all(TIME.as_bytes())?;
        for signal in columns {
            write!(out, ",{}", signal.column())?;
        }
        writeln!(out)?;
        for (time, values) in rows {
            let values = values.as_ref();
            if values.len() != columns.len() {
                return Err(io::Error::other(format!(
                    "a row of {} values for {} columns",
                    values.len(),
                    columns.len()
                )));
            }
            write!(out, "{}", time.micros() as f64 / 1e6)?;
            for (signal, value) in columns.iter().zip(values) {
                write_value(out, *signal, *value)?;
            }
            writeln!(out)?;
        }
        Ok(())
    })
}

fn write_value(out: &mut dyn Write, signal: Signal, value: Option<f64>) -> io::Result<()> {
    match value.filter(|value| value.is_finite()) {
        None => write!(out, ","),
        Some(degrees) if largest_angle_deg(signal).is_some() => {
            write!(out, ",{}", (degrees * 1e7).round() / 1e7)
        }
        Some(value) => write!(out, ",{}", value as f32),
    }
}
