//! What the columns of a table may be.

use super::census::Census;
use super::dbc_census::DbcSignalCount;
use super::proposal::{Proposal, propose};
use crate::numeric::rounding::round;
use crate::source::column_count::ColumnCount;
use crate::source::own_signals::units;
use crate::source::signal_table::{TIME, TimeUnit};
use estimator_core::Signal;
use std::fmt::Write as _;

/// Returns a column as a signal that may be one of ours.
fn as_signal(column: &ColumnCount) -> DbcSignalCount {
    DbcSignalCount {
        message: String::new(),
        identifier: String::new(),
        signal: column.column.clone(),
        unit: column.unit.clone().unwrap_or_default(),
        count: column.numbers,
        min: column.min.map(|min| round(min, 7)),
        max: column.max.map(|max| round(max, 7)),
        usual: None,
    }
}

/// Returns a `COLUMNS.toml` to start from, for what `census` does not have.
#[must_use]
pub fn proposed_columns(columns: &[ColumnCount], census: &Census) -> String {
    let time = proposed_time(columns).filter(|_| census.rows == 0);
    let is_time = |column: &&ColumnCount| time.is_none_or(|time| time.column != column.column);
    let others = columns.iter().filter(is_time);
    let signals: Vec<DbcSignalCount> = others.map(as_signal).collect();
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
        // Without it, a unit that is not known is an error.
        None if proposal.is_unit_unknown => writeln!(table, "# scale = {:?}", proposal.scale),
        None => writeln!(table, "scale = {:?}", proposal.scale),
    };
    table
}
