//! The rows of a signal table in the order of time, whether it is CSV or Parquet.

use super::frame_log::{Seconds, moved_to_zero};
use super::time_order::{TimeOrder, Timed};
use estimator_core::{Instant, Reading, Signal, Value};
use std::collections::BTreeMap;

/// Most rows that wait for earlier ones: some tens of MiB, and hours of a drive.
const MOST_WAITING: usize = (1 << 16) - 1;
/// Times that are apart by less than this are of one part, µs: rows may be shuffled within it.
const PART_US: i64 = 10_000_000;
/// From so far on within the times of an earlier part, a row is wrong, or another drive begins, µs.
const WITHIN_US: i64 = 1_000_000;
/// Most sets of signals that are told apart; all further ones count as the last.
const MOST_SETS: usize = 64;
/// What a slot has before its first row.
const NO_READING: Reading = Reading {
    signal: Signal::WheelSpeed,
    value: Value::NotAvailable,
};

/// One row of a table.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SignalRow<'a> {
    /// `time_s`, rounded to microseconds.
    pub time: Instant,
    /// The values that are not missing, in the order of [`Signal`]; may be empty.
    pub readings: &'a [Reading],
}

/// A row that waits. Its readings are in the store.
#[derive(Clone, Copy, Debug, Default)]
struct Row {
    line: u64,
    micros: i64,
    /// How far it stands behind later ones, µs.
    late_us: i64,
    slot: usize,
    readings: usize,
}

impl Timed for Row {
    fn micros(&self) -> i64 {
        self.micros
    }
}

/// Readings of the rows that wait, in slots of as many as a row may have.
struct Store {
    width: usize,
    readings: Vec<Reading>,
    free: Vec<usize>,
}

impl Store {
    /// Takes the readings of a row. Returns their slot.
    fn put(&mut self, readings: &[Reading]) -> usize {
        let slot = self.free.pop().unwrap_or_else(|| {
            let begin = self.readings.len();
            self.readings.resize(begin + self.width, NO_READING);
            begin
        });
        if let Some(own) = self.readings.get_mut(slot..slot + readings.len()) {
            own.copy_from_slice(readings);
        }
        slot
    }

    fn get(&self, row: &Row) -> &[Reading] {
        let of_row = self.readings.get(row.slot..row.slot + row.readings);
        of_row.unwrap_or_default()
    }
}

/// A row that is left out: its line, and the problem in words.
pub(super) type LeftOut = (u64, String);

/// Times of the rows with one set of signals. A table may begin with its newest row, or have its
/// parts in any order. But where times run over those of another part, the clock was set back.
#[derive(Debug)]
struct Parts {
    first_us: i64,
    last_us: i64,
    /// First and last times of the parts before.
    before: BTreeMap<i64, i64>,
    /// A row that is far from the one above. The next one shows whether a part begins there.
    doubtful: Option<Row>,
}

impl Parts {
    const fn from(micros: i64) -> Self {
        Self {
            first_us: micros,
            last_us: micros,
            before: BTreeMap::new(),
            doubtful: None,
        }
    }

    /// Returns whether a time is of the part of the row above.
    const fn is_near(&self, micros: i64) -> bool {
        (micros - self.last_us).abs() <= PART_US
    }

    /// Returns whether a time follows the one of the row above, in the first part.
    fn is_next(&self, micros: i64) -> bool {
        self.before.is_empty() && (0..=PART_US).contains(&(micros - self.last_us))
    }

    /// Returns whether a span of time runs over one of the parts before.
    fn runs_over(&self, first_us: i64, last_us: i64) -> bool {
        let mut begun = self.before.range(..last_us - WITHIN_US);
        begun
            .next_back()
            .is_some_and(|(_, last)| *last > first_us + WITHIN_US)
    }

    /// Takes a time of the part of the row above. Returns false if it runs over another part.
    fn goes_on(&mut self, micros: i64) -> bool {
        let first_us = self.first_us.min(micros);
        let last_us = self.last_us.max(micros);
        let is_right = !self.runs_over(first_us, last_us);
        if is_right {
            (self.first_us, self.last_us) = (first_us, last_us);
        }
        is_right
    }

    /// Begins a part.
    fn begin(&mut self, micros: i64) {
        self.before.insert(self.first_us, self.last_us);
        (self.first_us, self.last_us) = (micros, micros);
    }

    /// Returns whether a time is within a part.
    fn is_within(&self, micros: i64) -> bool {
        let is_of_own = (self.first_us + WITHIN_US..self.last_us - WITHIN_US).contains(&micros);
        is_of_own || self.runs_over(micros, micros)
    }

    /// Decides on the row that is in doubt, by the time of the next one: it is wrong if that is nearer to
    /// those before it.
    fn settle(&mut self, micros: i64) -> Option<Settled> {
        let doubtful = self.doubtful.take()?;
        if (micros - self.last_us).abs() < (micros - doubtful.micros).abs() {
            return Some(Settled::Wrong(doubtful));
        }
        self.begin(doubtful.micros);
        Some(Settled::Right(doubtful))
    }

    /// Places the next row.
    fn place(&mut self, row: Row) -> Placed {
        let is_near = self.is_near(row.micros);
        if is_near && self.goes_on(row.micros) {
            Placed::Taken
        } else if is_near || self.is_within(row.micros) {
            Placed::Over
        } else {
            self.doubtful = Some(row);
            Placed::Doubtful
        }
    }
}

/// What became of a row that was in doubt.
enum Settled {
    Right(Row),
    Wrong(Row),
}

/// What becomes of a row.
enum Placed {
    Taken,
    /// Its time is within those of earlier rows.
    Over,
    /// The next one decides.
    Doubtful,
}

/// Rows that may not be in order yet. Where the first time is negative, all are moved to begin with
/// zero.
pub(super) struct RowOrder {
    order: TimeOrder<Row>,
    store: Store,
    /// Rows of different signals are apart in some tables.
    parts: Vec<(Vec<Signal>, Parts)>,
    /// The parts of the row above.
    last_parts: usize,
    newest_us: Option<i64>,
    late: u64,
    latest_us: i64,
    /// Time of the first row that was let go, µs.
    first_us: Option<i64>,
    /// The row that was let go last.
    row: Row,
}

impl RowOrder {
    /// Creates an order of rows with so many readings at most.
    pub(super) fn new(width: usize) -> Self {
        Self {
            order: TimeOrder::new(MOST_WAITING),
            store: Store {
                width,
                readings: Vec::new(),
                free: Vec::new(),
            },
            parts: Vec::new(),
            last_parts: 0,
            newest_us: None,
            late: 0,
            latest_us: 0,
            first_us: None,
            row: Row::default(),
        }
    }

    /// Takes a row. Returns the rows that are now known to be wrong, or too late.
    pub(super) fn put(&mut self, line: u64, micros: i64, readings: &[Reading]) -> Vec<LeftOut> {
        let mut left_out = Vec::new();
        let row = Row {
            line,
            micros,
            late_us: (self.newest_us.unwrap_or(micros) - micros).max(0),
            slot: self.store.put(readings),
            readings: readings.len(),
        };
        let Some(parts) = self.parts_of(readings) else {
            let signals = readings.iter().map(|reading| reading.signal).collect();
            self.last_parts = self.parts.len();
            self.parts.push((signals, Parts::from(micros)));
            self.take(row, &mut left_out);
            return left_out;
        };
        // Nearly all rows.
        if parts.doubtful.is_none() && parts.is_next(micros) {
            parts.last_us = micros;
            self.take(row, &mut left_out);
            return left_out;
        }
        let last_us = parts.last_us;
        let settled = parts.settle(micros);
        let placed = parts.place(row);
        match settled {
            Some(Settled::Right(row)) => self.take(row, &mut left_out),
            Some(Settled::Wrong(row)) => {
                let problem = away(last_us, row.micros);
                left_out.push(self.leave_out(row, problem));
            }
            None => {}
        }
        match placed {
            Placed::Taken => self.take(row, &mut left_out),
            Placed::Over => {
                let time = Seconds(micros);
                let problem =
                    format!("time_s comes again: {time} is within the times of earlier rows");
                left_out.push(self.leave_out(row, problem));
            }
            Placed::Doubtful => {}
        }
        left_out
    }

    /// Returns the parts of the rows with these signals; mostly those of the row above.
    fn parts_of(&mut self, readings: &[Reading]) -> Option<&mut Parts> {
        let is_of = |(signals, _): &(Vec<Signal>, Parts)| {
            signals.len() == readings.len()
                && signals
                    .iter()
                    .zip(readings)
                    .all(|(of, reading)| *of == reading.signal)
        };
        if !self.parts.get(self.last_parts).is_some_and(is_of) {
            let last = (self.parts.len() == MOST_SETS).then_some(MOST_SETS - 1);
            self.last_parts = self.parts.iter().position(is_of).or(last)?;
        }
        self.parts.get_mut(self.last_parts).map(|(_, parts)| parts)
    }

    fn take(&mut self, row: Row, left_out: &mut Vec<LeftOut>) {
        if !self.order.put(row) {
            let time = Seconds(row.micros);
            let problem = format!("{time} stands too far behind later times");
            left_out.push(self.leave_out(row, problem));
            return;
        }
        self.late += u64::from(row.late_us > 0);
        self.latest_us = self.latest_us.max(row.late_us);
        self.newest_us = self.newest_us.max(Some(row.micros));
    }

    fn leave_out(&mut self, row: Row, problem: String) -> LeftOut {
        self.store.free.push(row.slot);
        (row.line, problem)
    }

    /// Lets all rows go: the table is over. Returns those that are too late.
    pub(super) fn end(&mut self) -> Vec<LeftOut> {
        let mut left_out = Vec::new();
        let doubtful = self.parts.iter_mut();
        let doubtful: Vec<Row> = doubtful.filter_map(|(_, of)| of.doubtful.take()).collect();
        for row in doubtful {
            self.take(row, &mut left_out);
        }
        self.order.end();
        left_out
    }

    /// Returns whether the table is over.
    pub(super) const fn is_over(&self) -> bool {
        self.order.is_over()
    }

    /// Goes to the next row. Returns false if an earlier one may still come, and at the end.
    pub(super) fn advance(&mut self) -> bool {
        let Some(row) = self.order.next() else {
            return false;
        };
        if self.first_us.is_some() {
            self.store.free.push(self.row.slot);
        }
        self.first_us.get_or_insert(row.micros);
        self.row = row;
        true
    }

    /// Returns the row.
    pub(super) fn row(&self) -> SignalRow<'_> {
        let micros = self.row.micros - self.first_us.unwrap_or(0).min(0);
        SignalRow {
            time: Instant::from_micros(u64::try_from(micros).unwrap_or(0)),
            readings: self.store.get(&self.row),
        }
    }

    /// Returns what was done to the times, in words.
    pub(super) fn mended(&self) -> impl Iterator<Item = String> {
        let late = (self.late > 0).then(|| {
            let (late, by) = (self.late, self.latest_us as f64 / 1e6);
            format!("{late} rows stand behind later ones, by up to {by:.1} s; put in order of time")
        });
        late.into_iter().chain(moved_to_zero(self.first_us))
    }
}

/// Says that a time is far from those around it.
fn away(last_us: i64, micros: i64) -> String {
    let (last, time) = (Seconds(last_us), Seconds(micros));
    let way = if micros < last_us {
        "runs backwards"
    } else {
        "jumps ahead"
    };
    format!("time_s {way} for one row, from {last} to {time}")
}
