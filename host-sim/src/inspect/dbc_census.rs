//! The signals of a `.dbc` file that are in a log, with the range of each.

use crate::numeric::rounding::round;
use crate::numeric::statistics::quantile;
use crate::source::can_frame::CanFrame;
use crate::source::own_signals::dbc::Dbc;
use crate::source::own_signals::dbc_message::{DbcMessage, DbcSignal};
use embedded_can::{Frame, Id};
use estimator_core::signal::Pgn;
use estimator_core::signal::own_message::FrameMatch;
use serde::Serialize;
use std::collections::BTreeMap;

/// Statistics of one signal of a `.dbc` file.
#[derive(Clone, Debug, Serialize)]
pub struct DbcSignalCount {
    /// Name of the message.
    pub message: String,
    /// Identifier, hexadecimal; or the parameter group, decimal.
    pub identifier: String,
    /// Name of the signal.
    pub signal: String,
    /// Unit, as the file writes it.
    pub unit: String,
    /// Number of frames that have it.
    pub count: u64,
    /// Smallest number, in `unit`; `None` if none is finite.
    pub min: Option<f64>,
    /// Largest number.
    pub max: Option<f64>,
    /// Range of nearly all numbers, where it is known: a receiver without a fix sends others.
    #[serde(skip)]
    pub usual: Option<(f64, f64)>,
}

/// Most numbers that are kept of a signal.
const MOST_KEPT: usize = 256;
/// Part of the numbers at each end that is not usual.
const UNUSUAL: f64 = 0.05;

#[derive(Clone, Debug)]
struct Seen {
    count: u64,
    min: f64,
    max: f64,
    /// Each number of the first ones, then each second of twice as many, and so on.
    kept: Vec<f64>,
    step: u64,
}

/// Counter of the signals of a `.dbc` file.
pub struct DbcCounter<'d> {
    messages: BTreeMap<FrameMatch, (&'d DbcMessage, Vec<Seen>)>,
}

impl<'d> DbcCounter<'d> {
    /// Creates a counter that has seen nothing.
    #[must_use]
    pub fn new(dbc: &'d Dbc) -> Self {
        let none = Seen {
            count: 0,
            min: f64::INFINITY,
            max: f64::NEG_INFINITY,
            kept: Vec::new(),
            step: 1,
        };
        let mut messages = BTreeMap::new();
        for message in dbc.messages() {
            // The first of several with the same frames, which a mapping by number takes too.
            let counts = (message, vec![none.clone(); message.signals.len()]);
            messages.entry(message.frames).or_insert(counts);
        }
        Self { messages }
    }

    /// Counts one frame.
    pub fn add(&mut self, frame: &CanFrame) {
        let matches = match frame.id() {
            Id::Standard(id) => [Some(FrameMatch::Standard(id.as_raw())), None],
            Id::Extended(id) => {
                let id = id.as_raw();
                let group = FrameMatch::Group(Pgn::from_raw(id).number);
                [Some(FrameMatch::Extended(id)), Some(group)]
            }
        };
        for key in matches.into_iter().flatten() {
            if let Some((message, seen)) = self.messages.get_mut(&key) {
                for (signal, seen) in message.signals.iter().zip(seen) {
                    seen.add(signal, frame.data());
                }
            }
        }
    }

    /// Returns the signals that were seen, in the order of the file's identifiers.
    #[must_use]
    pub fn finish(self) -> Vec<DbcSignalCount> {
        let mut counts = Vec::new();
        for (frames, (message, seen)) in self.messages {
            let signals = message.signals.iter().zip(seen);
            counts.extend(
                signals
                    .filter(|(_, seen)| seen.count > 0)
                    .map(|(signal, seen)| seen.finish(frames, message, signal)),
            );
        }
        counts
    }
}

impl Seen {
    fn add(&mut self, signal: &DbcSignal, payload: &[u8]) {
        let Some(number) = signal.read(payload) else {
            return;
        };
        self.count += 1;
        if number.is_finite() {
            self.min = self.min.min(number);
            self.max = self.max.max(number);
            self.keep(number);
        }
    }

    fn keep(&mut self, number: f64) {
        if !self.count.is_multiple_of(self.step) {
            return;
        }
        if self.kept.len() == MOST_KEPT {
            self.step *= 2;
            let mut is_odd = false;
            self.kept.retain(|_| {
                is_odd = !is_odd;
                !is_odd
            });
            if !self.count.is_multiple_of(self.step) {
                return;
            }
        }
        self.kept.push(number);
    }

    fn finish(
        self,
        frames: FrameMatch,
        message: &DbcMessage,
        signal: &DbcSignal,
    ) -> DbcSignalCount {
        let figure = |number: f64| number.is_finite().then(|| round(number, 7));
        DbcSignalCount {
            message: message.name.clone(),
            identifier: match frames {
                FrameMatch::Standard(id) => format!("{id:03X}"),
                FrameMatch::Extended(id) => format!("{id:08X}"),
                FrameMatch::Group(pgn) => format!("PGN {pgn}"),
            },
            signal: signal.name.clone(),
            unit: signal.unit.clone(),
            count: self.count,
            min: figure(self.min),
            max: figure(self.max),
            usual: (!self.kept.is_empty()).then(|| {
                let at = |part| round(quantile(self.kept.iter().copied(), part), 7);
                (at(UNUSUAL), at(1.0 - UNUSUAL))
            }),
        }
    }
}
