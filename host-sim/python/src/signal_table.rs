//! The signals of a log as a table, in the form of a signal table.

use crate::convert::with_report;
use arrow_array::RecordBatch;
use estimator_core::{Decoder, Instant, Reading, Signal, Value};
use host_sim::error::Result;
use host_sim::files::parquet::{ParquetColumn, in_memory};
use host_sim::source::input::{LogInput, for_each_input};
use host_sim::source::read_options::ReadOptions;
use std::collections::BTreeMap;
use std::path::Path;

/// Reads all signals of a log.
///
/// # Errors
/// Returns the error of the log.
pub fn read(path: &Path, options: &ReadOptions) -> Result<RecordBatch> {
    let own: Vec<Signal> = options
        .signals
        .iter()
        .flat_map(|own| own.signals())
        .collect();
    // The log itself has no columns of ignored signals, but the built-in messages have them.
    let is_left_out = |signal: Signal| own.contains(&signal) || options.ignore.contains(&signal);
    let mut decoder = Decoder::new();
    let mut sources: BTreeMap<Signal, u8> = BTreeMap::new();
    let mut columns = Columns::default();
    let report = for_each_input(
        path,
        options,
        |_| (),
        |input| match input {
            LogInput::Frame(timed) => {
                decoder.decode_at(timed.time, &timed.frame, |_, pgn, reading| {
                    if is_left_out(reading.signal) || !reading.value.is_available() {
                        return;
                    }
                    let first = *sources.entry(reading.signal).or_insert(pgn.source);
                    if first == pgn.source {
                        columns.push(timed.time, reading);
                    }
                });
            }
            LogInput::Reading(_, reading) if options.ignore.contains(&reading.signal) => {}
            LogInput::Reading(time, reading) => columns.push(time, reading),
        },
    )?;
    Ok(with_report(columns.finish(), &report))
}

/// Values of one signal by row; shorter than the table while the last rows lack the signal.
enum Values {
    Real(Vec<Option<f32>>),
    /// Angles have more digits.
    Degrees(Vec<Option<f64>>),
}

/// The columns of a table that grows.
#[derive(Default)]
struct Columns {
    time_s: Vec<f64>,
    newest: Option<Instant>,
    by_signal: BTreeMap<Signal, Values>,
}

impl Columns {
    /// Adds a reading to the row of its time, or to a new row if that has the signal already.
    fn push(&mut self, time: Instant, reading: Reading) {
        let rows = self.time_s.len();
        let is_taken = |values: &Values| values.len() == rows;
        let same_time = self.newest == Some(time);
        if !same_time || self.by_signal.get(&reading.signal).is_some_and(is_taken) {
            self.time_s.push(time.micros() as f64 / 1e6);
            self.newest = Some(time);
        }
        let row = self.time_s.len() - 1;
        match reading.value {
            Value::Real(value) => {
                let new = || Values::Real(Vec::new());
                let values = self.by_signal.entry(reading.signal).or_insert_with(new);
                values.put(row, f64::from(value));
            }
            Value::DegreesE7(e7) => {
                let new = || Values::Degrees(Vec::new());
                let values = self.by_signal.entry(reading.signal).or_insert_with(new);
                values.put(row, f64::from(e7) / 1e7);
            }
            _ => {}
        }
    }

    fn finish(self) -> RecordBatch {
        let rows = self.time_s.len();
        let mut columns = vec![ParquetColumn::numbers("time_s", self.time_s.into_iter())];
        for (signal, values) in self.by_signal {
            columns.push(match values {
                Values::Real(mut values) => {
                    values.resize(rows, None);
                    ParquetColumn::singles(signal.column(), values.into_iter())
                }
                Values::Degrees(mut values) => {
                    values.resize(rows, None);
                    ParquetColumn::optional(signal.column(), values.into_iter())
                }
            });
        }
        in_memory(columns, &[])
    }
}

impl Values {
    fn len(&self) -> usize {
        match self {
            Self::Real(values) => values.len(),
            Self::Degrees(values) => values.len(),
        }
    }

    /// Sets the value of a row that is behind all others.
    fn put(&mut self, row: usize, value: f64) {
        match self {
            Self::Real(values) => {
                values.resize(row, None);
                values.push(Some(value as f32));
            }
            Self::Degrees(values) => {
                values.resize(row, None);
                values.push(Some(value));
            }
        }
    }
}
