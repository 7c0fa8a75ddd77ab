//! From frames to samples: decoding, one source a signal, the sampler; and what was wrong, counted.

use crate::counters::Counters;
use crate::sampler::{Sample, Sampler};
use crate::signal::{
    Admission, Decoder, FrameOutcome, Reading, Rejection, Sender, Signal, SourceLock, Value,
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
        let outcome = decoder.decode_read(frame, |message, pgn, reading| {
            let sender = Some(Sender::new(message, pgn.source));
            used |= desk.take(reading.signal, reading.value, sender);
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
        self.desk.take(reading.signal, reading.value, None);
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
    fn take(&mut self, signal: Signal, value: Value, sender: Option<Sender>) -> bool {
        let Self {
            vehicle,
            tuning,
            counters,
            sources,
            sampler,
            now,
        } = self;
        let available = value.is_available();
        let mut switched = false;
        if let Some(sender) = sender {
            match sources.admit(signal, sender, *now, available) {
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
        sampler.record(vehicle, tuning, *now, reading, switched, counters);
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
