//! Which diagnostic answers become readings.

use super::parameters::{Parameter, name_of, parameters, signal_of, vehicle_number};
use super::transport::{Responder, Transport};
use crate::source::can_frame::TimedFrame;
use crate::source::vehicle_number::number_of;
use embedded_can::{Frame, Id};
use estimator_core::signal::Pgn;
use estimator_core::{Decoder, Instant, Reading, Signal};
use serde::Serialize;
use std::collections::BTreeMap;

/// Silence after which another controller may give a signal. A logger asks for some parameters only
/// each few seconds.
const SILENCE_S: f64 = 30.0;

/// Parameter groups that give signals of diagnostic answers too: EEC1, CCVS1, EC1, ETC2, AMB, EEC3.
const BROADCAST: [u32; 6] = [61_444, 65_265, 65_251, 61_445, 65_269, 65_247];

/// Statistics of one parameter.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct ObdCount {
    /// Its number, hexadecimal.
    pub parameter: String,
    /// Its name; `None` if the estimator could not use it.
    pub name: Option<&'static str>,
    /// Signal that it gives ([`Signal::column`]).
    pub signal: Option<&'static str>,
    /// Number of answers.
    pub count: u64,
    /// Number of answers left out: another controller, an own message or a broadcast one gives the
    /// signal.
    pub left_out: u64,
}

/// Reader of diagnostic answers.
///
/// Each signal comes from one controller, and only where neither an own message nor one that the bus
/// broadcasts gives it: these are newer and finer.
#[derive(Debug, Default)]
pub struct ObdAnswers {
    transport: Transport,
    /// Signals that come from elsewhere.
    given: Vec<Signal>,
    /// The controller that gives a signal, and its last answer.
    responders: BTreeMap<Signal, (Responder, Instant)>,
    /// Reads broadcast messages until their signals are known; from the first answer on.
    broadcast: Option<Decoder>,
    counts: BTreeMap<u8, ObdCount>,
    unreadable: u64,
    vehicle_number: Option<String>,
}

impl ObdAnswers {
    /// Creates a reader. Others give the signals in `given`.
    pub fn new(given: impl IntoIterator<Item = Signal>) -> Self {
        Self {
            given: given.into_iter().collect(),
            ..Self::default()
        }
    }

    /// Gives the readings of a frame to `sink`, in the order of [`Signal`].
    pub fn decode(&mut self, timed: &TimedFrame, mut sink: impl FnMut(Reading)) {
        let Some(responder) = Responder::of(&timed.frame) else {
            self.note_broadcast(timed);
            return;
        };
        let Some(answer) = self.transport.take(responder, timed.frame.data()) else {
            return;
        };
        if let Some(number) = vehicle_number(&answer) {
            self.vehicle_number = number_of(number);
            return;
        }
        let Some(found) = parameters(&answer) else {
            self.unreadable += 1;
            return;
        };
        self.broadcast.get_or_insert_default();
        let mut readings: Vec<Reading> = found
            .iter()
            .filter_map(|parameter| self.take(parameter, responder, timed.time))
            .collect();
        readings.sort_by_key(|reading| reading.signal);
        readings.into_iter().for_each(&mut sink);
    }

    /// Counts a parameter. Returns its reading, if that counts.
    fn take(
        &mut self,
        parameter: &Parameter,
        responder: Responder,
        now: Instant,
    ) -> Option<Reading> {
        let count = self.counts.entry(parameter.number).or_default();
        count.count += 1;
        let reading = parameter.reading()?;
        let is_free = |(_, last): &(Responder, Instant)| now.since(*last).as_secs_f64() > SILENCE_S;
        let known = self.responders.get(&reading.signal);
        let is_other = known.is_some_and(|known| known.0 != responder && !is_free(known));
        if is_other || self.given.contains(&reading.signal) {
            count.left_out += 1;
            return None;
        }
        self.responders.insert(reading.signal, (responder, now));
        Some(reading)
    }

    /// Notes the signals of a broadcast message.
    fn note_broadcast(&mut self, timed: &TimedFrame) {
        let Some(decoder) = &mut self.broadcast else {
            return;
        };
        let Id::Extended(id) = timed.frame.id() else {
            return;
        };
        if !BROADCAST.contains(&Pgn::from_raw(id.as_raw()).number) {
            return;
        }
        let given = &mut self.given;
        let note = |_, _, reading: Reading| {
            if reading.value.is_available() && !given.contains(&reading.signal) {
                given.push(reading.signal);
            }
        };
        decoder.decode_at(timed.time, &timed.frame, note);
    }

    /// Returns whether a signal comes from diagnostic answers.
    #[must_use]
    pub fn gives(&self, signal: Signal) -> bool {
        self.responders.contains_key(&signal) && !self.given.contains(&signal)
    }

    /// Returns what was answered, by ascending parameter.
    #[must_use]
    pub fn counts(&self) -> Vec<ObdCount> {
        let counts = self.counts.iter();
        let named = counts.map(|(number, count)| ObdCount {
            parameter: format!("{number:02X}"),
            name: name_of(*number),
            signal: signal_of(*number).map(Signal::column),
            ..count.clone()
        });
        named.collect()
    }

    /// Returns the vehicle identification number, if a controller was asked for it.
    #[must_use]
    pub fn vehicle_number(&self) -> Option<&str> {
        self.vehicle_number.as_deref()
    }

    /// Returns the number of answers that are of another service, or that cannot be taken apart.
    #[must_use]
    pub const fn unreadable(&self) -> u64 {
        self.unreadable
    }
}
