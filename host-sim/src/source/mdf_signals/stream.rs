//! The records of all groups that share their times, in the order of time.

use super::channel::Record;
use super::selection::Selected;
use super::source::Source;
use crate::error::{Error, Result};
use crate::source::damage::DamageCheck;
use crate::source::frame_log::Seconds;
use crate::source::log_file::LogFile;
use crate::source::mdf::conversion::Converted;
use crate::source::mdf::field::Clock;
use crate::source::mdf::mdf_file::MdfFile;
use crate::source::signal_table::checked;
use estimator_core::{Reading, Value};

/// The selected channels of one group.
pub(super) struct Column {
    pub source: Source,
    pub channels: Vec<Selected>,
}

/// A stream of records.
pub(super) struct Stream {
    /// The group with the times.
    pub times: Column,
    pub clock: Clock,
    /// Groups whose records have the times of the records with the same numbers.
    pub columns: Vec<Column>,
    /// Takes the damage of data that another stream reads too.
    pub repeated: Option<DamageCheck>,
    /// Time of the newest record, µs.
    pub micros: Option<i64>,
}

impl Stream {
    /// Goes to the next record with a time that is not before the last one. `micros` is `None` at the
    /// end.
    ///
    /// # Errors
    /// Returns an error of the disk, and what `damage` does not allow.
    pub(super) fn advance(
        &mut self,
        file: &mut MdfFile,
        damage: &mut DamageCheck,
        rows: u64,
    ) -> Result<()> {
        let last = self.micros.take();
        while self
            .times
            .source
            .advance(file, self.repeated.as_mut().unwrap_or(damage))?
        {
            let record = self.times.source.record();
            let index = match record.index {
                Some(index) => index,
                // Without its number, a record has no time.
                None if self.clock.is_virtual() => return Ok(()),
                None => 0,
            };
            let Some(micros) = self.clock.micros(record.bytes, index) else {
                damage.line(file.error("a record without its time", "seconds"), rows)?;
                continue;
            };
            if let Some(last) = last.filter(|last| micros < *last) {
                let (last, time) = (Seconds(last), Seconds(micros));
                let problem = format!("time runs backwards, from {last} to {time}");
                damage.line(file.error(&problem, "times that do not decrease"), rows)?;
                continue;
            }
            self.micros = Some(micros);
            break;
        }
        Ok(())
    }

    /// Reads the values of the newest record.
    ///
    /// # Errors
    /// As [`advance`](Self::advance).
    pub(super) fn read(
        &mut self,
        file: &mut MdfFile,
        damage: &mut DamageCheck,
        rows: u64,
        readings: &mut Vec<Reading>,
    ) -> Result<()> {
        let mut taken = Taken {
            time: Seconds(self.micros.unwrap_or(0)),
            rows,
            readings,
        };
        let record = self.times.source.record();
        taken.take(&self.times.channels, record, file.log(), damage)?;
        let Some(index) = record.index else {
            return Ok(()); // Nobody knows which records of the columns belong to this time.
        };
        for column in &mut self.columns {
            if column.source.seek(index, file, damage)? {
                let record = column.source.record();
                taken.take(&column.channels, record, file.log(), damage)?;
            }
        }
        Ok(())
    }
}

/// Where the values of a time go.
struct Taken<'a> {
    time: Seconds,
    rows: u64,
    readings: &'a mut Vec<Reading>,
}

impl Taken<'_> {
    fn take(
        &mut self,
        channels: &[Selected],
        record: Record,
        log: &LogFile,
        damage: &mut DamageCheck,
    ) -> Result<()> {
        for selected in channels {
            match selected.value(record) {
                Ok(None) => {}
                Ok(Some(value)) => {
                    let signal = selected.signal;
                    self.readings.push(Reading { signal, value });
                }
                Err(Impossible { words, expected }) => {
                    let problem = format!("{words} at {}; expected {expected}", self.time);
                    damage.line(Error::content(log.path(), problem), self.rows)?;
                }
            }
        }
        Ok(())
    }
}

/// A number that its signal cannot have.
struct Impossible {
    words: String,
    expected: &'static str,
}

impl Selected {
    /// Reads the value of a record; `None` if the record has none.
    fn value(&self, record: Record) -> std::result::Result<Option<Value>, Impossible> {
        let Some(raw) = self.channel.raw(record) else {
            return Ok(None);
        };
        let is = |code: &i64| raw.is(*code);
        if self.invalid.iter().any(is) {
            return Ok(Some(Value::NotAvailable));
        }
        let meant = self.values.iter().find(|(code, _)| raw.is(*code));
        let number = match (meant, self.channel.convert(raw)) {
            (Some((_, value)), _) => *value,
            (None, Some(Converted::Number(number))) => number * self.scale + self.offset,
            // A text among numbers says why there is none.
            (None, Some(Converted::Text)) => return Ok(Some(Value::NotAvailable)),
            (None, None) => return Ok(None),
        };
        checked(self.signal, Some(number))
            .map(Some)
            .map_err(|expected| {
                let (column, name) = (self.signal.column(), self.channel.name.escape_debug());
                Impossible {
                    words: format!("{column} is {number} (channel `{name}`)"),
                    expected,
                }
            })
    }
}
