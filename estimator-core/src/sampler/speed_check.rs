//! Plausibility of the readings of one speed sensor.

use super::latest::TimedValue;
use super::resolution::Resolution;
use super::speed_returns::Returns;
use crate::scalar::Scalar;
use crate::time::Instant;
use crate::tuning::{Detection, Tuning};

/// What a speed reading is worth.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Plausibility {
    /// It may be right.
    Plausible,
    /// No vehicle can have come from the last speed to this one.
    Jumped,
    /// The last readings go back and forth as those of two senders do.
    Contradicted,
    /// The sensor is stuck.
    Frozen,
    /// It is, and was behind a cell: that is certain from now on.
    Wrong { right_until: u32 },
}

/// The last readings of one sensor.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct SpeedCheck {
    last: Option<TimedValue>,
    /// Another speed, and the time since which it is reported.
    other: Option<(TimedValue, Instant)>,
    repeated: RepeatedSpeed,
    returns: Returns,
}

/// A speed that is reported again and again.
#[derive(Clone, Copy, Debug, Default)]
struct RepeatedSpeed {
    mps: f32,
    /// Engine speed over the gear ratio when it was first reported, rpm.
    turns: Option<f32>,
    readings: u8,
    /// Cell in which it was first reported.
    cell: u32,
    /// Whether the sensor is stuck at it. It stays so while the engine happens to turn as at first.
    is_stuck: bool,
    /// Whether the vehicle's speed is another by more than the steps of any sensor.
    is_wrong: bool,
    /// Resolution, m/s.
    resolution: Resolution,
}

impl SpeedCheck {
    /// Returns the smallest change of the readings so far, m/s; 0 where it is larger than the steps
    /// of any sensor.
    pub(super) fn resolution_mps(&self, tuning: &Detection) -> f32 {
        self.repeated.resolution.within(tuning.speed_step_mps)
    }

    /// Returns whether any reading has returned to where the speed was before the last one since this
    /// was asked.
    pub(super) const fn take_returns(&mut self) -> bool {
        self.returns.take_any()
    }

    /// Checks a reading in an open cell behind the one with number `cell`. `turns` is the engine speed
    /// over the ratio of the engaged gear, rpm.
    pub(super) fn check(
        &mut self,
        reading: TimedValue,
        cell: u32,
        turns: Option<f32>,
        tuning: &Tuning,
    ) -> Plausibility {
        let agreement = tuning.hold_times.agreement;
        let tuning = &tuning.detection;
        if let Some(last) = self.last {
            let leads = last.leads_to(&reading, tuning);
            if !leads {
                let since = match self.other {
                    Some((before, since)) if before.leads_to(&reading, tuning) => since,
                    _ => reading.time,
                };
                if reading.time.since(since) < agreement {
                    self.other = Some((reading, since));
                    return Plausibility::Jumped;
                }
            }
            let has_left_out = leads && self.other.is_some();
            let resolution_mps = self.resolution_mps(tuning);
            self.returns
                .take(last, &reading, has_left_out, resolution_mps, tuning);
        }
        self.other = None;
        self.last = Some(reading);
        let was_wrong = self.repeated.is_wrong;
        let is_stuck = self.repeated.is_stuck(reading.value, cell, turns, tuning);
        if self.returns.are_many(tuning) {
            Plausibility::Contradicted
        } else if !is_stuck {
            Plausibility::Plausible
        } else if self.repeated.is_wrong && !was_wrong {
            Plausibility::Wrong {
                right_until: self.repeated.cell,
            }
        } else {
            Plausibility::Frozen
        }
    }
}

impl TimedValue {
    /// Returns whether a vehicle may come from this speed to another.
    fn leads_to(&self, other: &Self, tuning: &Detection) -> bool {
        let seconds = other.time.seconds_since(self.time);
        let most_mps = tuning.speed_step_mps + tuning.speed_hardest_mps2 * seconds;
        (other.value - self.value).abs() <= most_mps
    }
}

impl RepeatedSpeed {
    fn is_stuck(&mut self, mps: f32, cell: u32, turns: Option<f32>, tuning: &Detection) -> bool {
        if mps != self.mps {
            let mut resolution = self.resolution;
            resolution.note(mps - self.mps);
            *self = Self {
                mps,
                turns,
                readings: 0,
                cell,
                is_stuck: false,
                is_wrong: false,
                resolution,
            };
            return false;
        }
        self.readings = self.readings.saturating_add(1);
        let (Some(first), Some(turns), Some(step_mps)) =
            (self.turns, turns, self.resolution.step())
        else {
            self.turns = self.turns.or(turns);
            return self.is_stuck;
        };
        let changed = (turns - first).abs() * mps;
        let relative = tuning.speed_frozen_change * mps;
        let allowed = Scalar::max(relative, tuning.speed_frozen_steps * step_mps) * first;
        self.is_stuck |= self.readings >= tuning.frozen_readings && changed > allowed;
        self.is_wrong |= self.is_stuck && changed > 2.0 * tuning.speed_step_mps * first;
        self.is_stuck
    }
}
