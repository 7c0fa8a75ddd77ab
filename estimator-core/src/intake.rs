//! From frames to samples: decoding, one source a signal, the sampler; and what was wrong, counted.

use crate::clock::{Clock, Verdict};
use crate::counters::Counters;
use crate::sampler::{Sample, Sampler};
use crate::signal::{
    Admission, Decoder, FrameOutcome, RateCheck, Reading, Rejection, Sender, Signal, SourceLock,
    Value,
};
use crate::time::Instant;
use crate::tuning::Tuning;
use crate::vehicle::{ParameterError, VehicleParameters};
use embedded_can::Frame;

/// What became of an input.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Outcome {
    /// Its readings count.
    Used,
    /// Nothing to use in it: another message, a part of a packet, a sender without the word.
    Ignored,
    /// Known, but unusable.
    Rejected(Rejection),
    /// Older than the input before it; left out.
    TimeBackwards,
    /// Far ahead of the input before it, and alone in that; left out.
    TimeAhead,
}

/// The way in: everything before the filter.
#[derive(Clone, Debug)]
pub struct Intake {
    decoder: Decoder,
    rates: RateCheck,
    pub(crate) desk: Desk,
}

/// Where readings are taken, and what happened is counted.
#[derive(Clone, Debug)]
pub(crate) struct Desk {
    pub(crate) vehicle: VehicleParameters,
    pub(crate) tuning: Tuning,
    /// The filter counts here too.
    pub(crate) counters: Counters,
    sources: SourceLock,
    sampler: Sampler,
    clock: Clock,
}

impl Intake {
    /// For this vehicle.
    ///
    /// # Errors
    /// The first parameter that no vehicle can have.
    pub fn new(vehicle: VehicleParameters, tuning: Tuning) -> Result<Self, ParameterError> {
        vehicle.check()?;
        Ok(Self {
            decoder: Decoder::new(),
            rates: RateCheck::new(),
            desk: Desk {
                vehicle,
                tuning,
                counters: Counters::default(),
                sources: SourceLock::new(),
                sampler: Sampler::new(),
                clock: Clock::new(),
            },
        })
    }

    /// Takes one frame, received at `now`.
    pub fn on_frame<F: Frame>(&mut self, now: Instant, frame: &F) -> Outcome {
        let Self {
            decoder,
            rates,
            desk,
        } = self;
        desk.counters.frames += 1;
        if let Some(out_of_time) = desk.begin(now) {
            return out_of_time;
        }
        let mut used = false;
        let outcome = decoder.decode_read(frame, |message, pgn, reading| {
            let sender = Some(Sender::new(message, pgn.source));
            used |= desk.take(reading.signal, reading.value, sender);
        });
        let counters = &mut desk.counters;
        match outcome {
            FrameOutcome::Decoded { message, .. } => {
                let now = desk.clock.now();
                desk.sampler.start(now);
                counters.frames_decoded += 1;
                if used {
                    if rates.exceeds(message, now) {
                        counters.rates_exceeded = counters.rates_exceeded.saturating_add(1);
                    }
                    Outcome::Used
                } else {
                    Outcome::Ignored
                }
            }
            FrameOutcome::Partial => Outcome::Ignored,
            FrameOutcome::Ignored => {
                counters.frames_ignored += 1;
                Outcome::Ignored
            }
            FrameOutcome::Rejected(rejection) => {
                let counter = match rejection {
                    Rejection::FastPacketOrder => &mut counters.fast_packets_broken,
                    Rejection::Remote | Rejection::Truncated => &mut counters.frames_malformed,
                };
                *counter = counter.saturating_add(1);
                Outcome::Rejected(rejection)
            }
        }
    }

    /// Takes one reading that came without a bus. Simultaneous readings go in the order of
    /// [`Signal`].
    pub fn on_reading(&mut self, now: Instant, reading: Reading) -> Outcome {
        if let Some(out_of_time) = self.desk.begin(now) {
            return out_of_time;
        }
        self.desk.take(reading.signal, reading.value, None);
        self.desk.sampler.start(self.desk.clock.now());
        Outcome::Used
    }

    /// The next cell that was driven to its end.
    pub fn next_sample(&mut self) -> Option<Sample> {
        self.desk.sampler.next_sample()
    }

    /// What happened so far.
    #[must_use]
    pub const fn counters(&self) -> &Counters {
        &self.desk.counters
    }

    /// The vehicle as given.
    #[must_use]
    pub const fn vehicle(&self) -> &VehicleParameters {
        &self.desk.vehicle
    }

    /// The tuning as given.
    #[must_use]
    pub const fn tuning(&self) -> &Tuning {
        &self.desk.tuning
    }
}

impl Desk {
    /// Time has come to what is told, or not if that is out of time.
    fn begin(&mut self, told: Instant) -> Option<Outcome> {
        let (counter, outcome) = match self.clock.hear(told) {
            Verdict::Follows => return None,
            Verdict::SetBack => (&mut self.counters.clocks_set_back, None),
            Verdict::Silent => (&mut self.counters.silences, None),
            Verdict::Late => (
                &mut self.counters.time_backwards,
                Some(Outcome::TimeBackwards),
            ),
            Verdict::FarAhead => (&mut self.counters.times_ahead, Some(Outcome::TimeAhead)),
        };
        *counter = counter.saturating_add(1);
        outcome
    }

    /// Takes a reading, from a message and an address if it comes from a bus; true if it is a
    /// measurement that counts.
    #[inline(never)] // The loop over the readings of a frame stays small: its state in registers.
    fn take(&mut self, signal: Signal, value: Value, sender: Option<Sender>) -> bool {
        let Self {
            vehicle,
            tuning,
            counters,
            sources,
            sampler,
            clock,
        } = self;
        let now = clock.now();
        let available = value.is_available();
        let mut switched = false;
        if let Some(sender) = sender {
            match sources.admit(signal, sender, now, available) {
                Admission::Admitted => {}
                Admission::Switched => {
                    switched = true;
                    counters.source_switches = counters.source_switches.saturating_add(1);
                }
                Admission::Refused => {
                    counters.other_source = counters.other_source.saturating_add(1);
                    return false;
                }
            }
        }
        if !available {
            count_missing(value, counters);
        }
        let reading = Reading { signal, value };
        sampler.record(vehicle, tuning, now, reading, switched, counters);
        available
    }
}

/// Counts a value that is no measurement.
#[inline(never)] // Seldom.
fn count_missing(value: Value, counters: &mut Counters) {
    let counter = match value {
        Value::NotAvailable => &mut counters.not_available,
        Value::Error | Value::Real(_) | Value::DegreesE7(_) => &mut counters.errors,
    };
    *counter = counter.saturating_add(1);
}
