//! From frames to samples: decoding, one source a signal, the sampler; and what was wrong, counted.

use crate::counters::Counters;
use crate::sampler::{Sample, Sampler};
use crate::signal::{Admission, Decoder, FrameOutcome, Reading, Rejection, SourceLock, Value};
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
    pub(crate) vehicle: VehicleParameters,
    pub(crate) tuning: Tuning,
    decoder: Decoder,
    sources: SourceLock,
    sampler: Sampler,
    newest: Instant,
    /// What happened so far; the filter counts here too.
    pub(crate) counters: Counters,
}

impl Intake {
    /// For this vehicle.
    ///
    /// # Errors
    /// The first parameter that no vehicle can have.
    pub fn new(vehicle: VehicleParameters, tuning: Tuning) -> Result<Self, ParameterError> {
        vehicle.check()?;
        Ok(Self {
            vehicle,
            tuning,
            decoder: Decoder::new(),
            sources: SourceLock::new(),
            sampler: Sampler::new(),
            newest: Instant::ZERO,
            counters: Counters::default(),
        })
    }

    /// Takes one frame, received at `now`.
    pub fn on_frame<F: Frame>(&mut self, now: Instant, frame: &F) -> Outcome {
        let Self {
            vehicle,
            tuning,
            decoder,
            sources,
            sampler,
            newest,
            counters,
        } = self;
        counters.frames = counters.frames.saturating_add(1);
        if now < *newest {
            counters.time_backwards = counters.time_backwards.saturating_add(1);
            return Outcome::TimeBackwards;
        }
        *newest = now;
        let mut used = false;
        let outcome = decoder.decode(frame, |message, pgn, reading| {
            let available = reading.value.is_available();
            match sources.admit(reading.signal, message, pgn.source, now, available) {
                Admission::Refused => {
                    counters.other_source = counters.other_source.saturating_add(1);
                }
                admission => {
                    let switched = admission == Admission::Switched;
                    if switched {
                        counters.source_switches = counters.source_switches.saturating_add(1);
                    }
                    count_value(reading.value, counters);
                    sampler.record(vehicle, tuning, now, reading, switched, counters);
                    used |= available;
                }
            }
        });
        match outcome {
            FrameOutcome::Decoded { .. } => {
                counters.frames_decoded = counters.frames_decoded.saturating_add(1);
                if used {
                    Outcome::Used
                } else {
                    Outcome::Ignored
                }
            }
            FrameOutcome::Partial => Outcome::Ignored,
            FrameOutcome::Ignored => {
                counters.frames_ignored = counters.frames_ignored.saturating_add(1);
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
        if now < self.newest {
            self.counters.time_backwards = self.counters.time_backwards.saturating_add(1);
            return Outcome::TimeBackwards;
        }
        self.newest = now;
        count_value(reading.value, &mut self.counters);
        self.sampler.record(
            &self.vehicle,
            &self.tuning,
            now,
            reading,
            false,
            &mut self.counters,
        );
        Outcome::Used
    }

    /// The next cell that was driven to its end.
    pub fn next_sample(&mut self) -> Option<Sample> {
        self.sampler.next_sample()
    }

    /// What happened so far.
    #[must_use]
    pub const fn counters(&self) -> &Counters {
        &self.counters
    }

    /// The vehicle as given.
    #[must_use]
    pub const fn vehicle(&self) -> &VehicleParameters {
        &self.vehicle
    }

    /// The tuning as given.
    #[must_use]
    pub const fn tuning(&self) -> &Tuning {
        &self.tuning
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
