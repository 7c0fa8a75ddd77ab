//! Rests of the torque: how long it stayed the same to the last bit, and by how much it then jumped.

use crate::sample::TorqueRest;
use crate::scalar::Scalar;
use crate::time::Instant;

/// Part of the largest torque so far from which on the engine is at full load.
const FULL_LOAD: f32 = 0.97;
/// Net torque up to which the engine drives nothing, % of the reference torque.
const OVERRUN_PERCENT: f32 = 1.0;
/// Shortest rest that counts, s: slower than the slowest usual sender of torque.
const SHORTEST_S: f32 = 0.3;

/// The rest that goes on, and the one that ended last.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct TorqueRests {
    percent: f32,
    largest_percent: f32,
    since: Option<Instant>,
    newest: Instant,
    per_percent_n: f32,
    at_limit_s: f32,
    ended: TorqueRest,
}

impl TorqueRests {
    /// Takes the net torque, % of the reference torque. `per_percent_n` is the force of one percent of
    /// it; zero where the driveline is open or shifts.
    pub(super) fn torque(&mut self, percent: f32, per_percent_n: f32, now: Instant) {
        let Some(since) = self.since else {
            self.begin(percent, per_percent_n, now);
            return;
        };
        let is_limit = per_percent_n == 0.0
            || self.percent <= OVERRUN_PERCENT
            || self.percent >= FULL_LOAD * self.largest_percent;
        if is_limit {
            self.at_limit_s += now.seconds_since(self.newest);
        }
        self.newest = now;
        if per_percent_n != 0.0 {
            self.per_percent_n = per_percent_n;
        }
        if percent != self.percent {
            let lasted_s = now.seconds_since(since);
            let jump_n = (percent - self.percent).abs() * self.per_percent_n;
            if lasted_s > SHORTEST_S && jump_n >= self.ended.jump_n {
                self.ended = TorqueRest {
                    ended_s: lasted_s,
                    jump_n,
                    ended_at_limit: self.at_limit_s > 0.5 * lasted_s,
                    ..TorqueRest::default()
                };
            }
            self.begin(percent, self.per_percent_n, now);
        }
    }

    fn begin(&mut self, percent: f32, per_percent_n: f32, now: Instant) {
        self.percent = percent;
        self.largest_percent = Scalar::max(self.largest_percent, percent);
        self.since = Some(now);
        self.newest = now;
        self.per_percent_n = per_percent_n;
        self.at_limit_s = 0.0;
    }

    /// Returns the rest that ended since the last call, and the one that goes on.
    pub(super) fn take(&mut self, now: Instant) -> TorqueRest {
        let resting_s = self.since.map_or(0.0, |since| now.seconds_since(since));
        let rest = TorqueRest {
            resting_s,
            per_percent_n: self.per_percent_n,
            rests_at_limit: self.at_limit_s > 0.5 * resting_s,
            ..self.ended
        };
        self.ended = TorqueRest::default();
        rest
    }
}
