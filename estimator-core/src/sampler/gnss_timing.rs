//! What the speed over ground shows of the receiver's latency and of the wheel speed's scale.
//!
//! Receiver and wheels measure the same accelerations. The lag at which both fit best is the latency
//! of the receiver; the ratio of both speeds is the scale of the wheel speed. The variances of their
//! difference at a row of lags are means that forget, and each reading updates a few of them. They
//! find delays of half a second and more; [`SpeedLag`] finds shorter ones, and finds them finer.

use super::lagged_differences::LaggedDifferences;
use super::latest::TimedValue;
use super::speed_lag::SpeedLag;
use crate::scalar::Scalar;
use crate::time::{Duration, Instant};
use crate::tuning::Detection;
use heapless::Deque;

/// Number of lags, and time between two of them.
const LAGS: usize = 32;
const STEP: Duration = Duration::from_micros(250_000);
/// Lags that one reading updates.
const AT_ONCE: u8 = 4;

/// The comparison of both speeds.
#[derive(Clone, Debug)]
pub(super) struct GnssTiming {
    /// Wheel speeds, m/s, the newest first, and the time of the newest.
    // A queue: to move an array takes one and a half kilobytes of flash, for `memmove`.
    wheels_mps: Deque<f32, { LAGS + 1 }>,
    newest: Option<Instant>,
    /// Speeds over ground less wheel speeds.
    differences: LaggedDifferences<LAGS>,
    /// Mean wheel speed, m/s.
    mean_wheels_mps: f32,
    latency: Option<Duration>,
    fine: SpeedLag,
    factor: f32,
}

impl Default for GnssTiming {
    fn default() -> Self {
        Self {
            wheels_mps: Deque::new(),
            newest: None,
            differences: LaggedDifferences::new(),
            mean_wheels_mps: 0.0,
            latency: None,
            fine: SpeedLag::new(),
            factor: 1.0,
        }
    }
}

impl GnssTiming {
    /// Returns the latency of the receiver, or the assumed one as long as it fits as well.
    pub(super) fn latency(&self, assumed: Duration) -> Duration {
        self.learned().unwrap_or(assumed)
    }

    /// Returns the latency that the speeds show: where both comparisons agree, the finer one.
    #[inline(never)] // Several places ask.
    fn learned(&self) -> Option<Duration> {
        let fine = self.fine.learned();
        let Some(coarse) = self.latency else {
            return fine;
        };
        let agrees = |fine: &Duration| fine.micros().abs_diff(coarse.micros()) < STEP.micros();
        fine.filter(agrees).or(Some(coarse))
    }

    /// Returns the way since a fix that arrives now was taken, m; `None` unless a long latency was
    /// learned and the speeds since then are known.
    pub(super) fn way_m(&self, now: Instant) -> Option<f32> {
        if !self.wheels_mps.is_full() || self.latency.is_none() {
            return None;
        }
        let latency_s = self.learned()?.seconds();
        let newest_s = Scalar::min(now.seconds_since(self.newest?), latency_s);
        let mut left_s = latency_s - newest_s;
        let mut way_m = newest_s * self.wheels_mps.front()?;
        let earlier = self.wheels_mps.iter().skip(1);
        for (later, earlier) in self.wheels_mps.iter().zip(earlier) {
            let piece_s = Scalar::min(left_s, STEP.seconds());
            way_m += piece_s * 0.5 * (later + earlier);
            left_s -= piece_s;
        }
        Some(way_m * self.factor)
    }

    /// Returns true over measured wheel speed; one unless they differ by more than wheels wear.
    pub(super) const fn speed_factor(&self) -> f32 {
        self.factor
    }

    /// Takes a change of the receiver: another one has another latency.
    pub(super) fn switch_receiver(&mut self) {
        self.fine.switch_receiver();
    }

    /// Returns by how much the force is later than the wheel speed, s; zero unless that is certain.
    pub(super) const fn traction_late_s(&self) -> f32 {
        self.fine.traction_late_s()
    }

    /// Takes the mean force since the last wheel speed, N.
    pub(super) const fn force(&mut self, force_n: f32) {
        self.fine.force(force_n);
    }

    /// Takes a wheel speed, without the factor. Returns by how much longer the latency is with it, s.
    pub(super) fn wheels(
        &mut self,
        speed: TimedValue,
        assumed: Duration,
        tuning: &Detection,
    ) -> f32 {
        let before = self.latency(assumed);
        self.fine.wheels(speed, assumed, tuning);
        self.keep_speed(speed);
        let after = self.latency(assumed);
        if after == before {
            return 0.0;
        }
        after.seconds() - before.seconds()
    }

    fn keep_speed(&mut self, speed: TimedValue) {
        match self.newest {
            Some(newest) if speed.time < newest + STEP => {}
            Some(newest) if speed.time.since(newest).micros() < 2 * STEP.micros() => {
                if self.wheels_mps.is_full() {
                    self.wheels_mps.pop_back();
                }
                let _ = self.wheels_mps.push_front(speed.value);
                self.newest = Some(newest + STEP);
            }
            _ => {
                self.wheels_mps.clear();
                let _ = self.wheels_mps.push_front(speed.value);
                self.newest = Some(speed.time);
            }
        }
    }

    /// Takes a speed over ground.
    pub(super) fn ground(
        &mut self,
        now: Instant,
        speed_mps: f32,
        assumed: Duration,
        tuning: &Detection,
    ) {
        self.fine.ground(now, speed_mps, tuning);
        let Some(newest) = self.newest else { return };
        if !self.wheels_mps.is_full() || speed_mps < tuning.turn_mps {
            return;
        }
        // Something carries the vehicle: a ferry, or a train.
        if self.wheels_mps.iter().all(|mps| *mps < tuning.standing_mps) {
            return;
        }
        let after = now.seconds_since(newest) / STEP.seconds();
        if after > 1.5 {
            return;
        }
        let gain = self.differences.gain(tuning.timing_readings);
        if self.differences.begins_round() {
            self.decide(assumed, tuning);
        }
        let Self {
            wheels_mps,
            mean_wheels_mps,
            differences,
            ..
        } = self;
        differences.update(AT_ONCE, gain, |lag, mean_mps| {
            // Between the wheel speed at this lag and the one after it.
            let later = wheels_mps.get(lag.saturating_sub(1))?;
            let earlier = wheels_mps.get(lag)?;
            let by_wheels_mps = earlier + Scalar::min(after, 1.0) * (later - earlier);
            if lag == 0 {
                *mean_wheels_mps += gain * (by_wheels_mps - *mean_wheels_mps);
            }
            Some(speed_mps - by_wheels_mps - mean_mps)
        });
    }

    /// Chooses the factor. The speeds are compared at the lag at which they fit best: at any other,
    /// a vehicle that gets faster has another ratio.
    fn scale(&mut self, best: usize, tuning: &Detection) {
        if self.mean_wheels_mps < tuning.turn_mps {
            return;
        }
        let ratio = 1.0 + self.differences.mean(best) / self.mean_wheels_mps;
        if (ratio - self.factor).abs() > tuning.speed_scale_change {
            let is_off = (ratio - 1.0).abs() > tuning.speed_scale_change;
            self.factor = if is_off { ratio } else { 1.0 };
        }
    }

    /// Chooses latency and factor.
    fn decide(&mut self, assumed: Duration, tuning: &Detection) {
        if self.differences.rounds() < tuning.timing_readings / 6 {
            return;
        }
        let best = self.differences.best();
        self.scale(best, tuning);
        let variance = |lag: usize| self.differences.variance(lag);
        let usual = (assumed.short_micros() / STEP.short_micros()) as usize;
        let at_usual = Scalar::min(variance(usual), variance(usual + 1));
        // What was learned stays until the advantage is half as large.
        let part = match self.latency {
            None => tuning.timing_part,
            Some(_) => 0.5 * (1.0 + tuning.timing_part),
        };
        if best <= usual + 1 || variance(best) > part * at_usual {
            self.latency = None;
            return;
        }
        let (before, at, after) = (variance(best - 1), variance(best), variance(best + 1));
        let bend = before + after - 2.0 * at;
        let aside = if after.is_finite() && bend > 0.0 {
            0.5 * (before - after) / bend
        } else {
            0.0
        };
        let micros = (best as f32 + aside) * STEP.micros() as f32;
        self.latency = Some(Duration::from_micros(micros as u64));
    }
}
