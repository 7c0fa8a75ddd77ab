//! The header of a table: which column has which signal.

use super::columns_file::ColumnsFile;
use super::rows::{ColumnName, delimiter_of, header_line};
use super::time_column::{TIME, TimeUnit};
use crate::error::{Error, Result};
use crate::files::nearest::nearest_in_words;
use crate::source::own_signals::units;
use crate::source::row_order::RowOrder;
use crate::source::signal_range::unit_of_column;
use estimator_core::Signal;
use std::path::Path;

/// Names of a time without its unit, the most telling first.
const TIMES: [&str; 5] = ["timestamp", "time", "datetime", "date_time", "utc_time"];
/// Names of others that mean one signal in one unit.
const ALIASES: [(&str, Signal); 6] = [
    ("lat", Signal::Latitude),
    ("latitude", Signal::Latitude),
    ("lon", Signal::Longitude),
    ("lng", Signal::Longitude),
    ("long", Signal::Longitude),
    ("longitude", Signal::Longitude),
];

/// Beyond this many seconds `f64` does not resolve microseconds well.
const LATEST_S: f64 = 4e9;

/// Why a row has no time.
pub(in super::super) enum NoTime {
    /// It is missing, or beyond all measurements.
    Wrong,
    /// Neither the header nor the value shows its unit.
    NoUnit,
}

/// A column of a signal, and how its numbers become ours.
#[derive(Clone, Copy, Debug)]
pub(in super::super) struct SignalColumn {
    pub index: usize,
    pub signal: Signal,
    pub scale: f64,
    pub offset: f64,
}

/// The column of the time; without a unit, its first value shows it.
#[derive(Clone, Debug)]
pub(in super::super) struct TimeColumn {
    pub index: usize,
    pub name: String,
    pub unit: Option<TimeUnit>,
}

/// What the header of a table has.
#[derive(Debug)]
pub(in super::super) struct HeaderColumns {
    pub time: TimeColumn,
    /// In the order of [`Signal`].
    pub columns: Vec<SignalColumn>,
    /// Columns that are not ours.
    pub ignored: Vec<String>,
    /// What was taken for ours under another name, in words.
    pub converted: Vec<String>,
}

impl HeaderColumns {
    /// Leaves out the columns of these signals.
    pub(in super::super) fn ignore(&mut self, signals: &[Signal]) {
        self.columns
            .retain(|column| !signals.contains(&column.signal));
    }

    /// Returns the signals that have a column, in the order of [`Signal`].
    pub(in super::super) fn signals(&self) -> impl Iterator<Item = Signal> {
        self.columns.iter().map(|column| column.signal)
    }

    /// Returns what was mended of the times, and what was taken for ours, in words.
    pub(in super::super) fn mended(&self, order: &RowOrder) -> Vec<String> {
        let converted = self.converted.iter().cloned();
        order.mended().chain(converted).collect()
    }
}

impl TimeColumn {
    /// Returns the time of a row, µs. Where the header has no unit, the first cell shows it.
    ///
    /// # Errors
    /// Returns why it has none.
    pub(in super::super) fn micros(
        &mut self,
        text: &str,
        number: Option<f64>,
    ) -> std::result::Result<i64, NoTime> {
        let unit = self.unit.or_else(|| TimeUnit::of_value(text, number));
        let unit = unit.ok_or(NoTime::NoUnit)?;
        let seconds = unit.seconds(text, number);
        let seconds = seconds.filter(|seconds| seconds.abs() < LATEST_S);
        let micros = (seconds.ok_or(NoTime::Wrong)? * 1e6).round() as i64;
        self.unit = Some(unit);
        Ok(micros)
    }
}

/// What a column is.
enum Found {
    Time(Option<TimeUnit>),
    Signal(Signal, f64, f64),
    Other,
}

/// Why the columns are not those of a table.
pub(in super::super) enum Problem {
    /// The table itself: what is wrong, and what was expected.
    Table(String, String),
    /// The mapping.
    Mapping(Error),
}

/// Returns what to do about a table whose columns are not ours.
const PROPOSE: &str = "; `roadgrade inspect TABLE --out columns.toml` proposes what its columns are, for \
                       --columns";

/// Finds the columns of the time and the signals.
pub(in super::super) fn columns_of(
    path: &Path,
    names: &[ColumnName],
    mapping: Option<&ColumnsFile>,
) -> std::result::Result<HeaderColumns, Problem> {
    let mut found: Vec<Found> = names.iter().map(of_name).collect();
    if let Some(mapping) = mapping {
        map(path, names, mapping, &mut found).map_err(Problem::Mapping)?;
    }
    let is_exact = |k: &usize| names.get(*k).is_some_and(|name| name.name == TIME);
    let times = || (0..found.len()).filter(|k| matches!(found.get(*k), Some(Found::Time(_))));
    refuse_twice(names, &found)?;
    let rank = |k: &usize| {
        let name = names.get(*k).map_or("", |name| &name.name);
        TIMES
            .iter()
            .position(|known| name.eq_ignore_ascii_case(known))
    };
    let time = times().find(is_exact).or_else(|| times().min_by_key(rank));
    let mut columns = Vec::new();
    let (mut ignored, mut converted) = (Vec::new(), Vec::new());
    for (index, (name, found)) in names.iter().zip(&found).enumerate() {
        let Found::Signal(signal, scale, offset) = *found else {
            if Some(index) != time {
                ignored.push(name.whole.clone());
            }
            continue;
        };
        if name.whole != signal.column() {
            converted.push(format!("column `{}` is {}", name.whole, signal.column()));
        }
        columns.push(SignalColumn {
            index,
            signal,
            scale,
            offset,
        });
    }
    let (Some(index), Some(Found::Time(unit))) = (time, time.and_then(|k| found.get(k))) else {
        let expected = format!("time_s in the header{}", propose(names));
        return Err(Problem::Table("no column time_s".to_owned(), expected));
    };
    if columns.is_empty() {
        let known = Signal::ALL.iter().map(|signal| signal.column());
        let alike = nearest_in_words(ignored.first().map_or("", String::as_str), known);
        let expected = format!(
            "any that `roadgrade columns` lists, such as {alike}{}",
            propose(names)
        );
        return Err(Problem::Table(
            "no column with a signal".to_owned(),
            expected,
        ));
    }
    columns.sort_by_key(|column| column.signal);
    let time = TimeColumn {
        index,
        name: names
            .get(index)
            .map_or_else(String::new, |name| name.whole.clone()),
        unit: *unit,
    };
    Ok(HeaderColumns {
        time,
        columns,
        ignored,
        converted,
    })
}

fn propose(names: &[ColumnName]) -> &'static str {
    if names.len() > 1 { PROPOSE } else { "" }
}

/// Replaces what the names mean by what the mapping says.
fn map(
    path: &Path,
    names: &[ColumnName],
    mapping: &ColumnsFile,
    found: &mut [Found],
) -> Result<()> {
    let all = || {
        names
            .iter()
            .map(|name| name.whole.clone())
            .collect::<Vec<_>>()
    };
    let place = |column: &str| {
        let by_whole = names.iter().position(|name| name.whole == column);
        by_whole.or_else(|| names.iter().position(|name| name.name == column))
    };
    let forget = |found: &mut [Found], is_same: &dyn Fn(&Found) -> bool| {
        for other in found.iter_mut().filter(|found| is_same(found)) {
            *other = Found::Other;
        }
    };
    if let Some(mapped) = &mapping.time {
        let k = place(&mapped.column).ok_or_else(|| mapping.missing(mapped, path, &all()))?;
        forget(found, &|found| matches!(found, Found::Time(_)));
        let of_header = names[k].unit.as_deref().and_then(TimeUnit::named);
        found[k] = Found::Time(mapped.conversion.or(of_header));
    }
    for (signal, mapped) in &mapping.signals {
        let k = place(&mapped.column).ok_or_else(|| mapping.missing(mapped, path, &all()))?;
        forget(
            found,
            &|found| matches!(found, Found::Signal(of, ..) if of == signal),
        );
        let unit = names[k].unit.as_deref().unwrap_or_default();
        if mapped.conversion.is_none() && units::is_doubtful(unit, *signal) {
            return Err(mapping.unknown_unit(mapped, *signal, unit));
        }
        let of_header = units::conversion(unit, *signal);
        let (scale, offset) = mapped.conversion.or(of_header).unwrap_or((1.0, 0.0));
        found[k] = Found::Signal(*signal, scale, offset);
    }
    Ok(())
}

/// Refuses two columns of one signal, or of the time in our unit.
fn refuse_twice(names: &[ColumnName], found: &[Found]) -> std::result::Result<(), Problem> {
    for (k, (name, column)) in names.iter().zip(found).enumerate() {
        let is_same = |(other, what): (&ColumnName, &Found)| match (column, what) {
            (Found::Time(_), Found::Time(_)) => name.name == TIME && other.name == TIME,
            (Found::Signal(a, ..), Found::Signal(b, ..)) => a == b,
            _ => false,
        };
        let mut others = names.iter().zip(found).take(k);
        if others.any(is_same) {
            let problem = format!("column `{}` is repeated", name.whole.escape_debug());
            return Err(Problem::Table(problem, "each column once".to_owned()));
        }
    }
    Ok(())
}

/// Returns what a column is by its name and unit.
fn of_name(column: &ColumnName) -> Found {
    let ColumnName { name, unit, .. } = column;
    let unit = unit.as_deref();
    let lower = name.to_lowercase().replace(' ', "_");
    if name == TIME {
        return Found::Time(Some(TimeUnit::Seconds));
    }
    if TIMES.contains(&&*lower) {
        return Found::Time(unit.and_then(TimeUnit::named));
    }
    let exact = Signal::from_column(name);
    let alias = ALIASES.iter().find(|(alias, _)| *alias == lower);
    let with_unit = || {
        let mut signals = Signal::ALL.iter().copied();
        signals.find(|signal| {
            let ending = unit_of_column(*signal);
            !ending.is_empty() && signal.column().strip_suffix(ending) == Some(&lower)
        })
    };
    let signal = match unit {
        None => exact.or(alias.map(|(_, signal)| *signal)),
        Some(_) => exact
            .or(alias.map(|(_, signal)| *signal))
            .or_else(with_unit),
    };
    let conversion = |signal| match unit {
        Some(unit) => units::conversion(unit, signal),
        None => Some((1.0, 0.0)),
    };
    match signal.and_then(|signal| Some((signal, conversion(signal)?))) {
        Some((signal, (scale, offset))) => Found::Signal(signal, scale, offset),
        None => Found::Other,
    }
}

/// Returns true if a text begins with the header of a table.
pub(in super::super) fn is_header(head: &[u8]) -> bool {
    let line = header_line(head);
    let delimiter = delimiter_of(line);
    let cells = line.split(|byte| *byte == delimiter);
    let found: Vec<Found> = cells
        .map(|cell| {
            let cell = String::from_utf8_lossy(cell.trim_ascii());
            of_name(&ColumnName::of(cell.trim_matches('"'), None))
        })
        .collect();
    let has = |is: fn(&Found) -> bool| found.iter().any(is);
    has(|found| matches!(found, Found::Time(Some(_))))
        || (has(|found| matches!(found, Found::Time(_))) && found.len() > 1)
}
