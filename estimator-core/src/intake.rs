//! From frames to samples: decoding, one source a signal, the sampler; and what was wrong, counted.

use crate::counters::Counters;
use crate::sampler::{Sample, Sampler};
use crate::signal::{
    Admission, Decoder, FrameOutcome, Reading, Rejection, Sender, SourceLock, Value,
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
}

/// The way in: everything before the filter.
#[derive(Clone, Debug)]
pub struct Intake {
    decoder: Decoder,
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
    /// Time of the newest input.
    now: Instant,
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
            desk: Desk {
                vehicle,
                tuning,
                counters: Counters::default(),
                sources: SourceLock::new(),
                sampler: Sampler::new(),
                now: Instant::ZERO,
            },
        })
    }

    /// Takes one frame, received at `now`.
    pub fn on_frame<F: Frame>(&mut self, now: Instant, frame: &F) -> Outcome {
        let Self { decoder, desk } = self;
        desk.counters.frames += 1;
        if !desk.begin(now) {
            return Outcome::TimeBackwards;
        }
        let mut used = false;
        let outcome = decoder.decode(frame, |message, pgn, reading| {
            used |= desk.take(Some(Sender::new(message, pgn.source)), reading);
        });
        let counters = &mut desk.counters;
        match outcome {
            FrameOutcome::Decoded { .. } => {
                desk.sampler.start(now);
                counters.frames_decoded += 1;
                if used {
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
    /// [`Signal`](crate::Signal).
    pub fn on_reading(&mut self, now: Instant, reading: Reading) -> Outcome {
        if !self.desk.begin(now) {
            return Outcome::TimeBackwards;
        }
        self.desk.take(None, reading);
        self.desk.sampler.start(now);
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
    /// Time has come to `now`; false, and counted, if it was later already.
    fn begin(&mut self, now: Instant) -> bool {
        let forward = now >= self.now;
        if forward {
            self.now = now;
        } else {
            self.counters.time_backwards = self.counters.time_backwards.saturating_add(1);
        }
        forward
    }

    /// Takes a reading, from a message and an address if it comes from a bus; true if it is a
    /// measurement that counts.
    #[inline(never)] // The loop over the readings of a frame stays small: its state in registers.
    fn take(&mut self, sender: Option<Sender>, reading: Reading) -> bool {
        let Self {
            vehicle,
            tuning,
            counters,
            sources,
            sampler,
            now,
        } = self;
        let available = reading.value.is_available();
        let mut switched = false;
        if let Some(sender) = sender {
            match sources.admit(reading.signal, sender, *now, available) {
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
        count_value(reading.value, counters);
        sampler.record(vehicle, tuning, *now, reading, switched, counters);
        available
    }
}

fn count_value(value: Value, counters: &mut Counters) {
    match value {
        Value::NotAvailable => {
            counters.not_available = counters.not_available.saturating_add(1);
        }
        Value::Error => counters.errors = counters.errors.saturating_add(1),
        Value::Real(value) if !value.is_finite() => {
            counters.errors = counters.errors.saturating_add(1);
        }
        Value::Real(_) | Value::DegreesE7(_) => {}
    }
}
