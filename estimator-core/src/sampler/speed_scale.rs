//! The scale of the wheel speed, from the speed over ground at the same time.

use crate::tuning::Detection;

/// Comparisons over which both speeds are averaged, and before the first decision: five minutes, one.
const MEMORY: u16 = 300;
const FEWEST: u16 = 60;

/// The comparison of both speeds.
#[derive(Clone, Copy, Debug)]
pub(super) struct SpeedScale {
    count: u16,
    ground_mps: f32,
    wheels_mps: f32,
    factor: f32,
}

impl SpeedScale {
    /// Before the first speed.
    pub(super) const NONE: Self = Self {
        count: 0,
        ground_mps: 0.0,
        wheels_mps: 0.0,
        factor: 1.0,
    };

    /// Returns true over measured wheel speed; one unless they differ by more than wheels wear.
    pub(super) const fn factor(&self) -> f32 {
        self.factor
    }

    /// Forgets the speeds: they were not of the same time. The factor stays.
    pub(super) const fn restart(&mut self) {
        self.count = 0;
    }

    /// Takes both speeds.
    pub(super) fn add(&mut self, ground_mps: f32, wheels_mps: f32) {
        self.count = (self.count + 1).min(MEMORY);
        let gain = 1.0 / f32::from(self.count);
        self.ground_mps += gain * (ground_mps - self.ground_mps);
        self.wheels_mps += gain * (wheels_mps - self.wheels_mps);
    }

    /// Decides on the factor.
    pub(super) fn decide(&mut self, tuning: &Detection) {
        if self.count < FEWEST || self.wheels_mps < tuning.slow_mps {
            return;
        }
        let ratio = self.ground_mps / self.wheels_mps;
        if (ratio - self.factor).abs() > tuning.speed_scale_change {
            let is_off = (ratio - 1.0).abs() > tuning.speed_scale_change;
            self.factor = if is_off { ratio } else { 1.0 };
        }
    }
}
