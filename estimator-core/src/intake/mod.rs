//! The intake: frames in, checked readings out to the sampler.
//!
//! Three checks stand between a bus and the sampler: the clock for the time of each input,
//! [`source_arbiter`] for one source a signal, and [`rate_monitor`] for messages that come too fast.
//! What they reject is counted.

mod clock;
pub mod rate_monitor;
pub mod source_arbiter;

pub use rate_monitor::{Rate, RateMonitor};
pub use source_arbiter::{Admission, Sender, SourceArbiter};

use crate::context::Context;
use crate::counters::{Counters, count};
use crate::sampler::Sampler;
use crate::signal::{
    Decoder, FrameOutcome, Reading, Rejection, Signal, Value, WHEEL_SPEED_MESSAGE,
};
use crate::time::Instant;
use crate::tuning::Tuning;
use clock::{Clock, TimeCheck};
use embedded_can::Frame;

/// What became of an input.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Outcome {
    /// At least one of its readings is used.
    Used,
    /// It has nothing to use: another message, a part of a packet, or another source.
    Ignored,
    /// The message is known, but the frame is unusable.
    Rejected(Rejection),
    /// Its time is before that of the input before it.
    TimeBackwards,
    /// Its time alone is far ahead of the input before it.
    TimeAhead,
}

/// The intake of one vehicle's buses.
#[derive(Clone, Debug)]
pub struct Intake {
    decoder: Decoder,
    rates: RateMonitor,
    checks: Checks,
}

/// The checks that every reading passes.
#[derive(Clone, Debug)]
struct Checks {
    clock: Clock,
    sources: SourceArbiter,
}

impl Intake {
    /// Creates an intake that has received nothing. A later change of `start` in the tuning
    /// has no effect on it.
    #[must_use]
    #[inline(always)] // See Estimator::new_in().
    pub fn new(tuning: &Tuning) -> Self {
        Self {
            decoder: Decoder::new(),
            rates: RateMonitor::new(),
            checks: Checks {
                clock: Clock::new(&tuning.hold_times),
                sources: SourceArbiter::new(),
            },
        }
    }

    /// Reserves a signal for [`on_reading`](Self::on_reading): the built-in messages no longer give
    /// it.
    pub fn reserve(&mut self, signal: Signal) {
        self.checks.sources.reserve(signal);
    }

    /// Leaves out a signal from now on, as if the bus did not have it.
    pub fn ignore(&mut self, signal: Signal) {
        self.checks.sources.ignore(signal);
    }

    /// Takes one frame, received at `now`, and gives its readings to the sampler.
    #[inline]
    pub fn on_frame<F: Frame>(
        &mut self,
        context: &mut Context,
        now: Instant,
        frame: &F,
        sampler: &mut Sampler,
    ) -> Outcome {
        let Self {
            decoder,
            rates,
            checks,
        } = self;
        context.counters.frames += 1;
        if let Some(out_of_time) = checks.time(context, now) {
            return out_of_time;
        }
        let mut used = false;
        let outcome = decoder.decode_read(now, frame, |message, pgn, reading| {
            let sender = Some(Sender::new(message, pgn.source));
            used |= checks.take(context, sampler, reading.signal, reading.value, sender);
        });
        match outcome {
            FrameOutcome::Decoded { message, .. } => {
                let now = checks.clock.now();
                sampler.start(now);
                context.counters.frames_decoded += 1;
                if used {
                    let rate = rates.take(message, now);
                    if rate != Rate::Usual {
                        take_unusual(rate, message, context, sampler);
                    }
                    Outcome::Used
                } else {
                    Outcome::Ignored
                }
            }
            FrameOutcome::Partial => Outcome::Ignored,
            FrameOutcome::Ignored => {
                context.counters.frames_ignored += 1;
                Outcome::Ignored
            }
            FrameOutcome::Rejected(rejection) => {
                count(match rejection {
                    Rejection::FastPacketOrder => &mut context.counters.fast_packets_broken,
                    Rejection::TransportOrder => &mut context.counters.sessions_broken,
                    Rejection::Remote | Rejection::Truncated | Rejection::TransportAnnouncement => {
                        &mut context.counters.frames_malformed
                    }
                });
                Outcome::Rejected(rejection)
            }
        }
    }

    /// Takes one reading that comes without a bus. Readings of the same time go in the order of
    /// [`Signal`].
    pub fn on_reading(
        &mut self,
        context: &mut Context,
        now: Instant,
        reading: Reading,
        sampler: &mut Sampler,
    ) -> Outcome {
        let Self { checks, .. } = self;
        if let Some(out_of_time) = checks.time(context, now) {
            return out_of_time;
        }
        if checks.sources.is_ignored(reading.signal) {
            return Outcome::Ignored;
        }
        checks.take(context, sampler, reading.signal, reading.value, None);
        sampler.start(checks.clock.now());
        Outcome::Used
    }
}

impl Checks {
    /// Advances the time to that of an input. Returns the outcome of an input that is out of time.
    #[inline]
    fn time(&mut self, context: &mut Context, time: Instant) -> Option<Outcome> {
        let counters = &mut context.counters;
        let (counter, outcome) = match self.clock.advance(time, &context.tuning.hold_times) {
            TimeCheck::Follows => return None,
            TimeCheck::SetBack => (&mut counters.clocks_set_back, None),
            TimeCheck::Silent => (&mut counters.silences, None),
            TimeCheck::Late => (&mut counters.time_backwards, Some(Outcome::TimeBackwards)),
            TimeCheck::FarAhead => (&mut counters.times_ahead, Some(Outcome::TimeAhead)),
        };
        count(counter);
        outcome
    }

    /// Passes a reading on to the sampler if its source owns the signal. `sender` is `None` for a
    /// reading that comes without a bus. Returns whether it is a measurement that counts.
    #[inline(never)] // The loop over the readings of a frame stays small: its state in registers.
    fn take(
        &mut self,
        context: &mut Context,
        sampler: &mut Sampler,
        signal: Signal,
        value: Value,
        sender: Option<Sender>,
    ) -> bool {
        let now = self.clock.now();
        let available = value.is_available();
        let mut switched = false;
        if let Some(sender) = sender {
            let hold_times = &context.tuning.hold_times;
            let admission = self
                .sources
                .admit(signal, sender, now, available, hold_times);
            match admission {
                Admission::Admitted => {}
                Admission::Switched | Admission::StoodIn => {
                    switched = true;
                    count(&mut context.counters.source_switches);
                    if signal == Signal::EngineTorque {
                        sampler.doubt_torque(admission == Admission::StoodIn);
                    }
                }
                Admission::Ignored => return false,
                Admission::Refused => {
                    count(&mut context.counters.other_source);
                    return false;
                }
            }
        }
        if !available {
            count_missing(value, &mut context.counters);
        }
        sampler.record(context, now, Reading { signal, value }, switched);
        available
    }
}

/// Takes the rate of a message that two senders may send.
#[inline(never)] // Rare.
fn take_unusual(rate: Rate, message: usize, context: &mut Context, sampler: &mut Sampler) {
    if rate != Rate::UsualAgain {
        count(&mut context.counters.rates_exceeded);
    }
    if rate != Rate::Exceeded && message == WHEEL_SPEED_MESSAGE {
        sampler.doubt_speed(rate == Rate::LongExceeded);
    }
}

/// Counts a value that is no measurement.
#[inline(never)] // Rare.
fn count_missing(value: Value, counters: &mut Counters) {
    count(match value {
        Value::NotAvailable => &mut counters.not_available,
        Value::Error | Value::Real(_) | Value::DegreesE7(_) => &mut counters.errors,
    });
}
