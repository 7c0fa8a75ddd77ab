//! The tables that `roadgrade inspect` prints.

use super::census::{Census, MessageCount, SignalCount};
use super::dbc_census::DbcSignalCount;
use super::needs::{Importance, Need, Presence};
use super::pgn_names::{TRANSPORT_DATA, TRANSPORT_MANAGEMENT, name_of};
use crate::source::column_count::ColumnCount;
use crate::source::interfaces::InterfaceCount;
use comfy_table::{CellAlignment, ContentArrangement, Table, presets};
use std::fmt::Write as _;

/// Number of rows of messages that the estimator does not decode, without `--all`.
const FEW: usize = 15;
/// Width of a table with sentences without a terminal, columns.
const WIDTH: u16 = 110;

/// Returns all tables of a log, below `head`.
pub fn text(
    head: &str,
    census: &Census,
    interfaces: &[InterfaceCount],
    needs: &[Need],
    all: bool,
) -> String {
    let limit = if all { usize::MAX } else { FEW };
    let mut out = String::new();
    overview(&mut out, head, census);
    if interfaces.len() > 1 {
        table_of(&mut out, interfaces);
    }
    if census.frames > 0 {
        messages(&mut out, census, limit);
        standard_ids(&mut out, census, limit);
        transported(&mut out, census, limit);
        diagnostic(&mut out, census);
    }
    signals(&mut out, census);
    missing(&mut out, needs);
    out
}

fn overview(out: &mut String, head: &str, census: &Census) {
    let (count, what) = if census.frames > 0 {
        (census.frames, "frames")
    } else {
        (census.rows, "rows")
    };
    line(
        out,
        &format!(
            "{head}, {} {what} in {:.3} s, from {:.6} s",
            grouped(count),
            census.duration_s,
            census.start_s
        ),
    );
    let unusable: u64 = census.messages.iter().map(|m| m.unusable).sum();
    for (count, what) in [
        (census.remote_frames, "remote frames"),
        (census.can_fd_frames, "CAN FD frames, left out"),
        (census.can_xl_frames, "CAN XL frames, left out"),
        (census.bus_errors, "bus errors, left out"),
        (
            census.invalid_records,
            "records that the file marks as invalid, left out",
        ),
        (
            census.foreign_messages,
            "messages of other networks, left out",
        ),
        (
            unusable,
            "frames of decoded messages unusable: too short, remote, or a fast packet with a hole",
        ),
    ] {
        if count > 0 {
            line(out, &format!("{} {what}", grouped(count)));
        }
    }
}

/// Prints the interfaces of a log that has several.
fn table_of(out: &mut String, interfaces: &[InterfaceCount]) {
    line(out, "\nInterfaces");
    let mut table = table(&["name", "frames", "left out, as another has them"]);
    align_right(&mut table, &[1, 2]);
    for count in interfaces {
        let InterfaceCount {
            name,
            frames,
            duplicates,
        } = count;
        table.add_row([name.clone(), grouped(*frames), some(*duplicates)]);
    }
    finish(out, &table);
}

/// Prints the decoded messages first, then the others by their share of the bus.
fn messages(out: &mut String, census: &Census, limit: usize) {
    if census.messages.is_empty() {
        return line(
            out,
            "\nNo parameter group: no frame has a 29-bit identifier.",
        );
    }
    let is_first =
        |m: &&MessageCount| m.decoded || [TRANSPORT_DATA, TRANSPORT_MANAGEMENT].contains(&m.pgn);
    let (first, mut rest): (Vec<_>, Vec<_>) = census.messages.iter().partition(is_first);
    rest.sort_by_key(|m| std::cmp::Reverse(m.frames));
    let (shown, left) = rest.split_at(rest.len().min(limit));

    line(out, "\nParameter groups");
    let mut table = table(&["PGN", "name", "from", "frames", "rate Hz", "unusable", ""]);
    align_right(&mut table, &[0, 3, 4, 5]);
    for message in first.iter().chain(shown) {
        table.add_row([
            message.pgn.to_string(),
            message.name.unwrap_or("-").to_owned(),
            addresses(&message.sources),
            grouped(message.frames),
            rate(message.rate_hz),
            some(message.unusable),
            if message.decoded { "decoded" } else { "" }.to_owned(),
        ]);
    }
    finish(out, &table);
    remainder(out, left.iter().map(|m| m.frames), "parameter groups");
}

/// Prints the parameters in diagnostic answers.
fn diagnostic(out: &mut String, census: &Census) {
    if census.obd.is_empty() {
        return;
    }
    line(out, "\nDiagnostic answers (OBD-II, service 01)");
    let mut table = table(&["parameter", "name", "answers", "not used", "signal"]);
    align_right(&mut table, &[2, 3]);
    for count in &census.obd {
        table.add_row([
            count.parameter.clone(),
            count.name.unwrap_or("-").to_owned(),
            grouped(count.count),
            some(count.left_out),
            count.signal.unwrap_or("").to_owned(),
        ]);
    }
    finish(out, &table);
    if census.obd_unreadable > 0 {
        let count = grouped(census.obd_unreadable);
        line(out, &format!("{count} answers of other services"));
    }
}

fn standard_ids(out: &mut String, census: &Census, limit: usize) {
    if census.standard_ids.is_empty() {
        return;
    }
    let mut ids: Vec<_> = census.standard_ids.iter().collect();
    if ids.len() > limit {
        ids.sort_by_key(|id| std::cmp::Reverse(id.frames));
    }
    let (shown, left) = ids.split_at(ids.len().min(limit));
    line(out, "\n11-bit identifiers (not J1939; not decoded)");
    let mut table = table(&["identifier", "frames", "rate Hz"]);
    align_right(&mut table, &[1, 2]);
    for id in shown {
        table.add_row([
            format!("{:03X}", id.id),
            grouped(id.frames),
            rate(id.rate_hz),
        ]);
    }
    finish(out, &table);
    remainder(out, left.iter().map(|id| id.frames), "identifiers");
}

fn transported(out: &mut String, census: &Census, limit: usize) {
    if census.transported.is_empty() {
        return;
    }
    let mut groups: Vec<_> = census.transported.iter().collect();
    if groups.len() > limit {
        groups.sort_by_key(|group| std::cmp::Reverse(group.announced));
    }
    let (shown, left) = groups.split_at(groups.len().min(limit));
    line(out, "\nIn transport-protocol packets (not decoded)");
    let mut table = table(&["PGN", "name", "announced", "bytes"]);
    align_right(&mut table, &[0, 2, 3]);
    for group in shown {
        table.add_row([
            group.pgn.to_string(),
            group.name.unwrap_or("-").to_owned(),
            grouped(group.announced),
            group.length_bytes.to_string(),
        ]);
    }
    finish(out, &table);
    remainder(out, left.iter().map(|g| g.announced), "parameter groups");
}

fn signals(out: &mut String, census: &Census) {
    if census.signals.is_empty() {
        return line(out, "\nNo signal that the estimator reads.");
    }
    line(out, "\nSignals");
    let is_bus = census.frames > 0;
    let mut table = table(&[
        "signal",
        if is_bus { "from" } else { "" },
        "count",
        "available",
        if is_bus { "not available" } else { "missing" },
        "error",
        "min",
        "mean",
        "max",
    ]);
    align_right(&mut table, &[2, 3, 4, 5, 6, 7, 8]);
    for signal in &census.signals {
        table.add_row([
            signal.signal.to_owned(),
            if is_bus {
                sender(signal)
            } else {
                String::new()
            },
            grouped(signal.count),
            format!(
                "{:.1} %",
                100.0 * signal.available as f64 / signal.count.max(1) as f64
            ),
            some(signal.not_available),
            some(signal.errors),
            figure(signal.signal, signal.min),
            figure(signal.signal, signal.mean),
            figure(signal.signal, signal.max),
        ]);
    }
    finish(out, &table);
}

fn missing(out: &mut String, needs: &[Need]) {
    line(out, "\nWhat is missing for an estimate");
    let mut table = table(&["what", "is", "in this log", "without it"]);
    table.set_content_arrangement(ContentArrangement::Dynamic);
    if table.width().is_none() {
        table.set_width(WIDTH);
    }
    for need in needs {
        let mut words = if need.presence == Presence::Present {
            String::new()
        } else {
            need.without.to_owned()
        };
        if let Some(note) = &need.note {
            let gap = if words.is_empty() { "" } else { "; " };
            let _ = write!(words, "{gap}{note}");
        }
        table.add_row([
            need.what,
            match need.importance {
                Importance::Needed => "needed",
                Importance::Optional => "optional",
            },
            match need.presence {
                Presence::Present => "there",
                Presence::NeverAvailable => "never available",
                Presence::Missing => "MISSING",
            },
            &words,
        ]);
    }
    finish(out, &table);
    let absent = needs
        .iter()
        .filter(|need| need.importance == Importance::Needed && need.presence != Presence::Present);
    let names: Vec<_> = absent.map(|need| need.what).collect();
    if names.is_empty() {
        line(out, "Nothing that an estimate needs is missing.");
    } else {
        line(out, &format!("Needed and missing: {}.", names.join(", ")));
    }
}

/// Returns the table of the signals of a `.dbc` file that are in a log, below a headline.
pub fn dbc_text(signals: &[DbcSignalCount]) -> String {
    let mut out = String::new();
    if signals.is_empty() {
        line(&mut out, "\nNo message of the .dbc file is in this log.");
        return out;
    }
    line(&mut out, "\nSignals of the .dbc file");
    let mut table = table(&[
        "message",
        "identifier",
        "signal",
        "unit",
        "count",
        "min",
        "max",
    ]);
    align_right(&mut table, &[4, 5, 6]);
    for signal in signals {
        table.add_row([
            signal.message.clone(),
            signal.identifier.clone(),
            signal.signal.clone(),
            signal.unit.clone(),
            grouped(signal.count),
            figure(&signal.signal, signal.min),
            figure(&signal.signal, signal.max),
        ]);
    }
    finish(&mut out, &table);
    out
}

/// Returns the columns of a table as a table.
pub fn columns_text(columns: &[ColumnCount]) -> String {
    let mut out = String::new();
    line(&mut out, "\nColumns of the table");
    let mut table = table(&["column", "unit", "numbers", "min", "max", "other text"]);
    align_right(&mut table, &[2, 3, 4]);
    for column in columns {
        table.add_row([
            column.column.clone(),
            column.unit.clone().unwrap_or_default(),
            grouped(column.numbers),
            figure(&column.column, column.min),
            figure(&column.column, column.max),
            column.text.clone().unwrap_or_default(),
        ]);
    }
    finish(&mut out, &table);
    out
}

pub(super) fn table(header: &[&str]) -> Table {
    let mut table = Table::new();
    table.load_style(presets::ASCII_MARKDOWN);
    table.set_header(header);
    table
}

/// Aligns columns to the right, headers included.
pub(super) fn align_right(table: &mut Table, columns: &[usize]) {
    for column in columns {
        if let Some(column) = table.column_mut(*column) {
            column.set_cell_alignment(CellAlignment::Right);
        }
    }
}

pub(super) fn finish(out: &mut String, table: &Table) {
    line(out, &table.trim_fmt());
}

fn remainder(out: &mut String, counts: impl ExactSizeIterator<Item = u64>, what: &str) {
    let left = counts.len();
    if left > 0 {
        let total = grouped(counts.sum());
        line(
            out,
            &format!(" and {left} more {what} with {total} frames (--all lists them)"),
        );
    }
}

pub(super) fn line(out: &mut String, text: &str) {
    out.push_str(text);
    out.push('\n');
}

fn sender(signal: &SignalCount) -> String {
    match (signal.pgn, signal.source) {
        (Some(pgn), Some(source)) => {
            let name = name_of(pgn).map_or_else(|| pgn.to_string(), str::to_owned);
            format!("{name} 0x{source:02X}")
        }
        _ => "own".to_owned(),
    }
}

fn addresses(sources: &[u8]) -> String {
    let words: Vec<_> = sources
        .iter()
        .take(4)
        .map(|s| format!("0x{s:02X}"))
        .collect();
    let more = sources.len().saturating_sub(words.len());
    let tail = if more > 0 {
        format!(" and {more} more")
    } else {
        String::new()
    };
    words.join(" ") + &tail
}

fn rate(rate_hz: Option<f64>) -> String {
    rate_hz.map_or_else(|| "-".to_owned(), |hz| format!("{hz:.2}"))
}

fn some(count: u64) -> String {
    if count > 0 {
        grouped(count)
    } else {
        "-".to_owned()
    }
}

/// Formats a number. Decimals depend on the unit: a position has more than a speed.
pub(super) fn figure(signal: &str, value: Option<f64>) -> String {
    let decimals = match signal {
        "latitude_deg" | "longitude_deg" => 7,
        _ => 3,
    };
    value.map_or_else(|| "-".to_owned(), |v| format!("{v:.decimals$}"))
}

/// Formats a count with separated thousands.
pub(super) fn grouped(count: u64) -> String {
    let digits = count.to_string();
    let mut text = String::new();
    for (k, digit) in digits.chars().enumerate() {
        if k > 0 && (digits.len() - k).is_multiple_of(3) {
            text.push(',');
        }
        text.push(digit);
    }
    text
}
