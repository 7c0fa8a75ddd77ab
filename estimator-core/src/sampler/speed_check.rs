//! Plausibility of the readings of one speed sensor.

use super::latest::TimedValue;
use super::resolution::Resolution;
use crate::scalar::Scalar;
use crate::time::Instant;
use crate::tuning::Detection;

/// What a speed reading is worth.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Plausibility {
    /// It may be right.
    Plausible,
    /// No vehicle can have come from the last speed to this one.
    Jumped,
    /// The sensor is stuck.
    Frozen,
}

/// The last readings of one sensor.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct SpeedCheck {
    last: Option<TimedValue>,
    /// Another speed, and the time since which it is reported.
    other: Option<(TimedValue, Instant)>,
    repeated: RepeatedSpeed,
}

/// A speed that is reported again and again.
#[derive(Clone, Copy, Debug, Default)]
struct RepeatedSpeed {
    mps: f32,
    /// Engine speed over the gear ratio when it was first reported, rpm.
    turns: Option<f32>,
    readings: u8,
    /// Whether the sensor is stuck at it. It stays so while the engine happens to turn as at first.
    is_stuck: bool,
    /// Resolution, m/s.
    resolution: Resolution,
}

impl SpeedCheck {
    /// Returns the smallest change of the readings so far, m/s; 0 where it is larger than the steps
    /// of any sensor.
    pub(super) fn resolution_mps(&self, tuning: &Detection) -> f32 {
        self.repeated.resolution.within(tuning.speed_step_mps)
    }

    /// Checks a reading. `turns` is the engine speed over the ratio of the engaged gear, rpm.
    pub(super) fn check(
        &mut self,
        now: Instant,
        mps: f32,
        turns: Option<f32>,
        tuning: &Detection,
    ) -> Plausibility {
        let reading = TimedValue {
            value: mps,
            time: now,
        };
        if let Some(last) = self.last
            && !last.leads_to(&reading, tuning)
        {
            let since = match self.other {
                Some((before, since)) if before.leads_to(&reading, tuning) => since,
                _ => now,
            };
            if now.since(since) < tuning.speed_believed {
                self.other = Some((reading, since));
                return Plausibility::Jumped;
            }
        }
        self.other = None;
        self.last = Some(reading);
        if self.repeated.is_stuck(mps, turns, tuning) {
            Plausibility::Frozen
        } else {
            Plausibility::Plausible
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
    fn is_stuck(&mut self, mps: f32, turns: Option<f32>, tuning: &Detection) -> bool {
        if mps != self.mps {
            let mut resolution = self.resolution;
            resolution.note(mps - self.mps);
            *self = Self {
                mps,
                turns,
                readings: 0,
                is_stuck: false,
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
        self.is_stuck |= self.readings >= tuning.speed_frozen_readings && changed > allowed;
        self.is_stuck
    }
}
