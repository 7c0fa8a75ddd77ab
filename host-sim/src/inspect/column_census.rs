//! The columns of a table, with the range of each, and what they may be.

use super::census::Census;
use super::dbc_census::DbcSignalCount;
use super::proposal::{Proposal, propose};
use crate::error::Result;
use crate::files::kind::PARQUET_MAGIC;
use crate::files::parquet;
use crate::numeric::rounding::round;
use crate::source::log_file::LogFile;
use crate::source::own_signals::units;
use crate::source::signal_table::{ColumnName, TIME, TableRows, TimeUnit};
use estimator_core::Signal;
use serde::Serialize;
use std::fmt::Write as _;
use std::path::Path;

/// Statistics of one column of a table.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ColumnCount {
    /// As the header has it.
    pub column: String,
    /// Unit, as the header or the row below it has it.
    pub unit: Option<String>,
    /// Number of cells that are numbers.
    pub numbers: u64,
    /// Smallest number.
    pub min: Option<f64>,
    /// Largest number.
    pub max: Option<f64>,
    /// The first cell that is no number and not empty.
    pub text: Option<String>,
}

impl ColumnCount {
    fn of(name: ColumnName) -> Self {
        Self {
            column: name.whole,
            unit: name.unit,
            numbers: 0,
            min: None,
            max: None,
            text: None,
        }
    }

    fn add(&mut self, number: f64) {
        self.numbers += 1;
        self.min = Some(self.min.map_or(number, |min| min.min(number)));
        self.max = Some(self.max.map_or(number, |max| max.max(number)));
    }

    fn as_signal(&self) -> DbcSignalCount {
        DbcSignalCount {
            message: String::new(),
            identifier: String::new(),
            signal: self.column.clone(),
            unit: self.unit.clone().unwrap_or_default(),
            count: self.numbers,
            min: self.min.map(|min| round(min, 7)),
            max: self.max.map(|max| round(max, 7)),
        }
    }
}

/// Reads all columns of a table, also of one that is not understood.
///
/// # Errors
/// Returns an error if the file cannot be read.
pub fn count_columns(path: &Path) -> Result<Vec<ColumnCount>> {
    let mut file = LogFile::open(path)?;
    if file.look_at_head().starts_with(PARQUET_MAGIC) {
        return count_parquet(path);
    }
    let mut rows = TableRows::new(file)?;
    let mut columns: Vec<ColumnCount> = rows.names().into_iter().map(ColumnCount::of).collect();
    while rows.advance()? {
        for (k, column) in columns.iter_mut().enumerate() {
            let number = rows.number(k);
            let cell = rows.record().get(k).unwrap_or_default();
            match number.or_else(|| TableRows::switch(cell)) {
                Some(number) => column.add(number),
                None if column.text.is_none() && !TableRows::is_missing(cell) => {
                    column.text = Some(String::from_utf8_lossy(cell).into_owned());
                }
                None => {}
            }
        }
    }
    Ok(columns)
}

fn count_parquet(path: &Path) -> Result<Vec<ColumnCount>> {
    let opened = parquet::open(path)?;
    let names = opened.number_names();
    let name = |name: &String| ColumnCount::of(ColumnName::of(name, None));
    let mut columns: Vec<ColumnCount> = names.iter().map(name).collect();
    let mut batches = opened.batches(names)?;
    while let Some(batch) = batches.next_batch()? {
        for (column, numbers) in columns.iter_mut().zip(batch) {
            let finite = numbers.into_iter().flatten().filter(|n| n.is_finite());
            finite.for_each(|number| column.add(number));
        }
    }
    Ok(columns)
}

/// Returns a `COLUMNS.toml` to start from, for what `census` does not have.
#[must_use]
pub fn proposed_columns(columns: &[ColumnCount], census: &Census) -> String {
    let time = proposed_time(columns).filter(|_| census.rows == 0);
    let is_time = |column: &&ColumnCount| time.is_none_or(|time| time.column != column.column);
    let others = columns.iter().filter(is_time);
    let signals: Vec<DbcSignalCount> = others.map(ColumnCount::as_signal).collect();
    let proposals = propose(&signals, census);
    if time.is_none() && proposals.is_empty() {
        return "# No column of the table fits a signal of ours by name, unit and range.\n\
                # `roadgrade columns` lists ours.\n"
            .to_owned();
    }
    let time = time.map(time_table);
    let tables = proposals
        .iter()
        .map(|proposal| signal_table(proposal, columns));
    time.into_iter()
        .chain(tables)
        .collect::<Vec<_>>()
        .join("\n")
}

/// Returns the column that has a time by its name.
fn proposed_time(columns: &[ColumnCount]) -> Option<&ColumnCount> {
    let rank = |column: &ColumnCount| {
        let name = column.column.to_lowercase();
        let is_date = column
            .text
            .as_deref()
            .and_then(|text| TimeUnit::of_value(text, None));
        let names = [TIME, "timestamp", "time", "date", "epoch", "utc"];
        let by_name = names.iter().position(|known| name.contains(known));
        let of_unit = column.unit.as_deref().and_then(TimeUnit::named);
        let is_only_t = of_unit.is_some() && name.split([' ', '[', '(']).next() == Some("t");
        match (by_name, is_only_t, is_date) {
            (Some(rank), ..) => Some(rank),
            (None, true, _) => Some(names.len()),
            (None, false, Some(_)) => Some(names.len() + 1),
            _ => None,
        }
    };
    let ranked = columns
        .iter()
        .filter_map(|column| Some((rank(column)?, column)));
    ranked
        .min_by_key(|(rank, _)| *rank)
        .map(|(_, column)| column)
}

fn time_table(column: &ColumnCount) -> String {
    let of_name = column.unit.as_deref().and_then(TimeUnit::named);
    let text = column.text.as_deref().unwrap_or_default();
    let unit = of_name.or_else(|| TimeUnit::of_value(text, column.min));
    let seen = match (column.min, column.max) {
        (Some(min), Some(max)) => format!("{min} to {max}"),
        _ => text.to_owned(),
    };
    let doubt = if unit.is_none() {
        "; its unit is not known: check it"
    } else {
        ""
    };
    format!(
        "# seen: {}{doubt}\n[columns.{TIME}]\ncolumn = {}\nunit = \"{}\"\n",
        seen.replace(char::is_control, " "),
        toml::Value::from(&*column.column),
        unit.unwrap_or(TimeUnit::Seconds).name()
    )
}

fn signal_table(proposal: &Proposal, columns: &[ColumnCount]) -> String {
    let mut table = format!(
        "{}[columns.{}]\ncolumn = {}\n",
        proposal.comment(),
        proposal.signal,
        toml::Value::from(&*proposal.source)
    );
    let column = columns
        .iter()
        .find(|column| column.column == proposal.source);
    let unit = column.and_then(|column| column.unit.as_deref());
    let signal = Signal::from_column(proposal.signal);
    let known = unit
        .zip(signal)
        .filter(|(unit, signal)| units::conversion(unit, *signal).is_some());
    let _ = match known {
        Some((unit, _)) => writeln!(table, "unit = {}", toml::Value::from(unit)),
        None => writeln!(table, "scale = {:?}", proposal.scale),
    };
    table
}
