//! The content of a log: its messages, and the range of each signal.

use super::pgn_names::name_of;
use crate::numeric::rounding::round;
use crate::source::can_frame::TimedFrame;
use crate::source::frame_log::Skipped;
use crate::source::frame_readings::FrameReadings;
use crate::source::mdf_signals::ChannelCount;
use crate::source::obd::ObdCount;
use crate::source::read_options::ReadOptions;
use crate::source::signal_table::SignalRow;
use embedded_can::{Frame, Id};
use estimator_core::signal::{FrameOutcome, Pgn};
use estimator_core::{Decoder, Instant, Reading, Signal, Value};
use rustc_hash::FxHashMap;
use serde::Serialize;
use std::collections::{BTreeMap, BTreeSet};

/// Content of a log.
#[derive(Clone, Debug, Default, Serialize)]
pub struct Census {
    /// Time of the first frame or row, s, as in the log.
    pub start_s: f64,
    /// Time from the first to the last frame or row, s.
    pub duration_s: f64,
    /// Number of classic CAN frames; 0 in a signal table.
    pub frames: u64,
    /// Number of rows; 0 in a log of frames.
    pub rows: u64,
    /// Parameter groups (29-bit identifiers), by ascending PGN.
    pub messages: Vec<MessageCount>,
    /// 11-bit identifiers, ascending. J1939 and NMEA 2000 use none.
    pub standard_ids: Vec<StandardCount>,
    /// Parameter groups that the transport protocol announced, by ascending PGN.
    pub transported: Vec<TransportedCount>,
    /// Parameters in diagnostic answers (OBD-II), ascending.
    pub obd: Vec<ObdCount>,
    /// Diagnostic answers of another service, or that cannot be taken apart.
    pub obd_unreadable: u64,
    /// Remote frames; they request data and carry none.
    pub remote_frames: u64,
    /// CAN FD frames; they are skipped.
    pub can_fd_frames: u64,
    /// CAN XL frames; they are skipped.
    pub can_xl_frames: u64,
    /// Bus errors that the interface reported; they are skipped.
    pub bus_errors: u64,
    /// Records that their file marks as invalid; they are skipped.
    pub invalid_records: u64,
    /// Messages of other networks in the same file; they are skipped.
    pub foreign_messages: u64,
    /// Decoded signals, in the order of [`Signal`], then by source address.
    pub signals: Vec<SignalCount>,
    /// Channels of a log with decoded signals, in the order of the file.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub channels: Vec<ChannelCount>,
}

/// Statistics of one parameter group.
#[derive(Clone, Debug, Serialize)]
pub struct MessageCount {
    /// Parameter group number.
    pub pgn: u32,
    /// Acronym, if known.
    pub name: Option<&'static str>,
    /// Whether the estimator decodes it.
    pub decoded: bool,
    /// Source addresses, ascending.
    pub sources: Vec<u8>,
    /// Number of frames.
    pub frames: u64,
    /// Mean rate, Hz; `None` for a single frame.
    pub rate_hz: Option<f64>,
    /// Frames of a decoded message that are too short, remote, or out of sequence.
    pub unusable: u64,
}

/// Statistics of one 11-bit identifier.
#[derive(Clone, Debug, Serialize)]
pub struct StandardCount {
    /// The identifier.
    pub id: u16,
    /// Number of frames.
    pub frames: u64,
    /// Mean rate, Hz; `None` for a single frame.
    pub rate_hz: Option<f64>,
}

/// A multi-packet parameter group.
#[derive(Clone, Debug, Serialize)]
pub struct TransportedCount {
    /// Parameter group number.
    pub pgn: u32,
    /// Acronym, if known.
    pub name: Option<&'static str>,
    /// Number of announcements.
    pub announced: u64,
    /// Length in the last announcement, bytes.
    pub length_bytes: u16,
}

/// Statistics of one signal from one source address.
#[derive(Clone, Debug, Serialize)]
pub struct SignalCount {
    /// Name with unit ([`Signal::column`]).
    pub signal: &'static str,
    /// Its parameter group; `None` in a signal table, for an own message and a
    /// diagnostic answer.
    pub pgn: Option<u32>,
    /// Its source address; `None` in a signal table, for an own message and a
    /// diagnostic answer.
    pub source: Option<u8>,
    /// Number of readings, or of rows of a table.
    pub count: u64,
    /// Number of readings with a measurement.
    pub available: u64,
    /// Number of readings "not available", or of empty cells.
    pub not_available: u64,
    /// Number of readings "error" or with a reserved code.
    pub errors: u64,
    /// Smallest measurement, in the unit of `signal`.
    pub min: Option<f64>,
    /// Mean measurement.
    pub mean: Option<f64>,
    /// Largest measurement.
    pub max: Option<f64>,
}

impl Census {
    /// Returns the number of measurements of any of `signals`.
    #[must_use]
    pub fn available(&self, signals: &[Signal]) -> u64 {
        self.of(signals).map(|count| count.available).sum()
    }

    /// Returns the largest measurement of any of `signals`.
    #[must_use]
    pub fn largest(&self, signals: &[Signal]) -> Option<f64> {
        self.of(signals)
            .filter_map(|count| count.max)
            .reduce(f64::max)
    }

    /// Returns the statistics of any of `signals`.
    pub fn of(&self, signals: &[Signal]) -> impl Iterator<Item = &SignalCount> {
        self.signals
            .iter()
            .filter(|count| signals.iter().any(|s| s.column() == count.signal))
    }
}

/// Number of events of one kind, with the times of the first and the last.
#[derive(Clone, Copy, Debug, Default)]
struct EventTally {
    count: u64,
    first: Instant,
    last: Instant,
}

impl EventTally {
    fn add(&mut self, now: Instant) {
        if self.count == 0 {
            self.first = now;
        }
        self.last = now;
        self.count += 1;
    }

    fn duration_s(&self) -> f64 {
        self.last.since(self.first).micros() as f64 / 1e6
    }

    fn rate_hz(&self) -> Option<f64> {
        let seconds = self.duration_s();
        (seconds > 0.0).then(|| round((self.count - 1) as f64 / seconds, 3))
    }
}

#[derive(Debug, Default)]
struct Group {
    tally: EventTally,
    sources: BTreeSet<u8>,
    unusable: u64,
}

/// Running statistics of a signal.
#[derive(Clone, Copy, Debug, Default)]
struct Range {
    count: u64,
    available: u64,
    errors: u64,
    sum: f64,
    min: f64,
    max: f64,
}

impl Range {
    fn add(&mut self, value: Value) {
        self.count += 1;
        let number = match value {
            Value::Real(number) => f64::from(number),
            Value::DegreesE7(angle) => f64::from(angle) / 1e7,
            Value::NotAvailable => return,
            Value::Error => {
                self.errors += 1;
                return;
            }
        };
        let is_first = self.available == 0;
        self.min = if is_first {
            number
        } else {
            self.min.min(number)
        };
        self.max = if is_first {
            number
        } else {
            self.max.max(number)
        };
        self.sum += number;
        self.available += 1;
    }

    fn finish(&self, signal: Signal, sender: Option<Pgn>) -> SignalCount {
        let figure = |value: f64| (self.available > 0).then(|| round(value, 7));
        SignalCount {
            signal: signal.column(),
            pgn: sender.map(|pgn| pgn.number),
            source: sender.map(|pgn| pgn.source),
            count: self.count,
            available: self.available,
            not_available: self.count - self.available - self.errors,
            errors: self.errors,
            min: figure(self.min),
            mean: figure(self.sum / self.available as f64),
            max: figure(self.max),
        }
    }
}

/// Counter of the frames of a bus.
#[derive(Default)]
pub struct BusCounter {
    /// Signals that are left out of all messages.
    left_out: Vec<Signal>,
    /// Signals that are left out of the built-in ones.
    not_built_in: Vec<Signal>,
    decoder: Decoder,
    all: EventTally,
    remote: u64,
    groups: BTreeMap<u32, Group>,
    standard: BTreeMap<u16, EventTally>,
    transported: BTreeMap<u32, (u64, u16)>,
    /// By signal and, for built-in messages, PGN and source address.
    signals: FxHashMap<(Signal, Option<(u32, u8)>), Range>,
    readings: FrameReadings,
}

impl BusCounter {
    /// Creates a counter of a bus that is read so.
    #[must_use]
    pub fn of(options: &ReadOptions) -> Self {
        let own = options.signals.iter().flat_map(|own| own.signals());
        Self {
            left_out: options.ignore.clone(),
            not_built_in: options.ignore.iter().copied().chain(own).collect(),
            readings: FrameReadings::of(options.signals.as_ref()),
            ..Self::default()
        }
    }

    /// Counts one frame.
    pub fn add(&mut self, timed: &TimedFrame) {
        let TimedFrame { time, frame } = timed;
        self.all.add(*time);
        self.remote += u64::from(frame.is_remote_frame());
        self.add_readings(timed);
        let pgn = match frame.id() {
            Id::Standard(id) => {
                self.standard.entry(id.as_raw()).or_default().add(*time);
                return;
            }
            Id::Extended(id) => Pgn::from_raw(id.as_raw()),
        };
        let group = self.groups.entry(pgn.number).or_default();
        group.tally.add(*time);
        group.sources.insert(pgn.source);
        let (signals, ignored) = (&mut self.signals, &self.not_built_in);
        let take = |_, pgn: Pgn, reading: Reading| {
            if ignored.contains(&reading.signal) {
                return;
            }
            let key = (reading.signal, Some((pgn.number, pgn.source)));
            signals.entry(key).or_default().add(reading.value);
        };
        let outcome = self.decoder.decode_at(*time, frame, take);
        if matches!(outcome, FrameOutcome::Rejected(_)) {
            group.unusable += 1;
        }
        if let Some((announced, length_bytes)) = frame.announcement() {
            let (count, length) = self.transported.entry(announced).or_default();
            *count += 1;
            *length = length_bytes;
        }
    }

    /// Counts the own signals of a frame, and those of a diagnostic answer.
    fn add_readings(&mut self, timed: &TimedFrame) {
        let (signals, ignored) = (&mut self.signals, &self.left_out);
        self.readings.decode(timed, |Reading { signal, value }| {
            if !ignored.contains(&signal) {
                signals.entry((signal, None)).or_default().add(value);
            }
        });
    }

    /// Returns the census.
    #[must_use]
    pub fn finish(self, skipped: Skipped) -> Census {
        let decoded: BTreeSet<u32> = estimator_core::signal::messages()
            .map(|m| m.pgn())
            .collect();
        Census {
            start_s: self.all.first.micros() as f64 / 1e6,
            duration_s: self.all.duration_s(),
            frames: self.all.count,
            rows: 0,
            messages: self
                .groups
                .into_iter()
                .map(|(pgn, group)| MessageCount {
                    pgn,
                    name: name_of(pgn),
                    decoded: decoded.contains(&pgn),
                    sources: group.sources.into_iter().collect(),
                    frames: group.tally.count,
                    rate_hz: group.tally.rate_hz(),
                    unusable: group.unusable,
                })
                .collect(),
            standard_ids: self
                .standard
                .into_iter()
                .map(|(id, tally)| StandardCount {
                    id,
                    frames: tally.count,
                    rate_hz: tally.rate_hz(),
                })
                .collect(),
            transported: self
                .transported
                .into_iter()
                .map(|(pgn, (announced, length_bytes))| TransportedCount {
                    pgn,
                    name: name_of(pgn),
                    announced,
                    length_bytes,
                })
                .collect(),
            obd: self.readings.obd().counts(),
            obd_unreadable: self.readings.obd().unreadable(),
            remote_frames: self.remote,
            can_fd_frames: skipped.can_fd,
            can_xl_frames: skipped.can_xl,
            bus_errors: skipped.bus_errors,
            invalid_records: skipped.invalid,
            foreign_messages: skipped.foreign,
            signals: BTreeMap::from_iter(self.signals)
                .into_iter()
                .map(|((signal, sender), range)| {
                    let pgn = sender.map(|(number, source)| Pgn { number, source });
                    range.finish(signal, pgn)
                })
                .collect(),
            channels: Vec::new(),
        }
    }
}

/// Counter of the rows of a signal table.
pub struct TableCounter {
    all: EventTally,
    columns: BTreeMap<Signal, Range>,
}

impl TableCounter {
    /// Creates a counter for a table with these columns.
    pub fn new(columns: impl IntoIterator<Item = Signal>) -> Self {
        Self {
            all: EventTally::default(),
            columns: columns
                .into_iter()
                .map(|signal| (signal, Range::default()))
                .collect(),
        }
    }

    /// Counts one row.
    pub fn add(&mut self, row: &SignalRow) {
        self.all.add(row.time);
        for Reading { signal, value } in row.readings {
            self.columns.entry(*signal).or_default().add(*value);
        }
    }

    /// Returns the census.
    #[must_use]
    pub fn finish(self) -> Census {
        let rows = self.all.count;
        Census {
            start_s: self.all.first.micros() as f64 / 1e6,
            duration_s: self.all.duration_s(),
            rows,
            signals: self
                .columns
                .into_iter()
                .map(|(signal, range)| {
                    // An empty cell is not a reading.
                    let range = Range {
                        count: rows,
                        ..range
                    };
                    range.finish(signal, None)
                })
                .collect(),
            ..Census::default()
        }
    }
}
