//! Whether a speed sensor can be right.

use super::latest::Timed;
use crate::scalar::Scalar;
use crate::time::{Duration, Instant};

/// No vehicle on tyres speeds up or slows down faster, m/s².
const HARDEST_MPS2: f32 = 10.0;
/// What two readings may differ by besides, m/s: noise, and steps of 1 km/h.
const STEP_MPS: f32 = 0.3;
/// Time for which readings agree on another speed until it is the one.
const BELIEVED: Duration = Duration::from_millis(1_000);
/// Readings in a row that tell the same speed to the last digit, part by which the engine's speed
/// has changed meanwhile, and how many of the sensor's own steps that is, when it is stuck.
const STUCK_READINGS: u8 = 20;
const STUCK_CHANGE: f32 = 0.005;
const STUCK_STEPS: f32 = 3.0;

/// What a reading is worth.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Worth {
    /// It may be right.
    Good,
    /// No vehicle has come from the last speed to this one.
    Leapt,
    /// The sensor is stuck.
    Frozen,
}

/// What one sensor told.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Speedometer {
    last: Option<Timed>,
    /// Another speed, and since when it is told.
    other: Option<(Timed, Instant)>,
    same: Same,
}

/// A speed that is told again and again.
#[derive(Clone, Copy, Debug, Default)]
struct Same {
    mps: f32,
    /// What the driveline turned like when it was first told.
    turns: Option<f32>,
    readings: u8,
    /// The sensor is stuck at it: also while the engine happens to turn as it did at first.
    stuck: bool,
    /// Smallest change told so far, m/s.
    step_mps: Option<f32>,
}

impl Speedometer {
    /// Judges a reading. `turns` is what a closed driveline turns like at the engine, in any unit
    /// that goes with the wheels' speed.
    pub(super) fn judge(&mut self, now: Instant, mps: f32, turns: Option<f32>) -> Worth {
        let told = Timed {
            value: mps,
            time: now,
        };
        if let Some(last) = self.last
            && !last.leads_to(&told)
        {
            let since = match self.other {
                Some((before, since)) if before.leads_to(&told) => since,
                _ => now,
            };
            if now.since(since) < BELIEVED {
                self.other = Some((told, since));
                return Worth::Leapt;
            }
        }
        self.other = None;
        self.last = Some(told);
        if self.same.is_stuck(mps, turns) {
            Worth::Frozen
        } else {
            Worth::Good
        }
    }
}

impl Timed {
    /// Whether a vehicle may come from this speed to another.
    fn leads_to(&self, other: &Self) -> bool {
        let seconds = other.time.since(self.time).seconds();
        (other.value - self.value).abs() <= STEP_MPS + HARDEST_MPS2 * seconds
    }
}

impl Same {
    fn is_stuck(&mut self, mps: f32, turns: Option<f32>) -> bool {
        if mps != self.mps {
            let step_mps = (mps - self.mps).abs();
            *self = Self {
                mps,
                turns,
                readings: 0,
                stuck: false,
                step_mps: self
                    .step_mps
                    .map_or(Some(step_mps), |least| Some(Scalar::min(least, step_mps))),
            };
            return false;
        }
        self.readings = self.readings.saturating_add(1);
        let (Some(first), Some(turns), Some(step_mps)) = (self.turns, turns, self.step_mps) else {
            self.turns = self.turns.or(turns);
            return self.stuck;
        };
        let changed = (turns - first).abs() * mps;
        let allowed = Scalar::max(STUCK_CHANGE * mps, STUCK_STEPS * step_mps) * first;
        self.stuck |= self.readings >= STUCK_READINGS && changed > allowed;
        self.stuck
    }
}
