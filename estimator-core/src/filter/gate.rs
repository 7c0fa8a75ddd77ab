//! Which altitudes to believe.
//!
//! A fix whose innovation is beyond what its variance allows is left out. A single one is an
//! outlier. Several in a row, all off by about as much, are a step of the receiver's slow error
//! (other satellites, a street canyon): that error is reopened by as much and takes the step
//! up; altitude, slope, bias and scale stay what they were.
//!
//! How noisy single fixes are and how far the slow error wanders is learned: receivers differ by
//! a factor of ten in both. A gate that takes a noisy one for a good one would pick the fixes that
//! please it, and a filter that takes a good one for a noisy one would not learn the bias from it.

use super::learned::{SensorNoise, SlowSpread, Spread};
use crate::scalar::Scalar;

/// Normalised squared innovation beyond which a fix is left out: five standard deviations. Errors
/// among houses have heavier tails than the normal distribution.
const LIMIT: f32 = 25.0;
/// Fixes left out in a row before they are believed after all.
const PATIENCE: u8 = 4;
/// A step is one if the fixes left out agree within this part of their offset.
const AGREEMENT: f32 = 0.5;

/// Time over which the slow error of GNSS is told from the receiver's noise, s.
const ERROR_STRETCH_S: f32 = 16.0;

/// What to do with a fix.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Verdict {
    /// Fuse it.
    Fuse,
    /// Leave it out.
    Reject,
    /// Fuse it with the slow error reopened by this much, m.
    Reopen(f32),
    /// Set the altitude from it: there was none, or it counts from another datum.
    SetAnew,
}

/// Remembers the fixes left out in a row, and how noisy fixes were.
#[derive(Clone, Copy, Debug)]
pub(super) struct Gate {
    rejected: u8,
    offset_m: f32,
    spread: Spread,
    error_spread: SlowSpread,
}

impl Gate {
    /// With nothing left out, and what is known of the noise.
    pub(super) fn new(noise: &SensorNoise) -> Self {
        Self {
            rejected: 0,
            offset_m: 0.0,
            // A fifth to ten times the believed sigma; some thirty fixes.
            spread: Spread::new(noise.altitude, 0.05, 100.0, 0.03),
            error_spread: SlowSpread::new(noise.gnss_error, ERROR_STRETCH_S),
        }
    }

    /// Learned over believed variance of a single fix.
    pub(super) const fn spread(&self) -> f32 {
        self.spread.ratio()
    }

    /// Learned over believed variance of the slow error.
    pub(super) const fn error_spread(&self) -> f32 {
        self.error_spread.ratio()
    }

    /// Time goes on.
    pub(super) fn pass(&mut self, duration_s: f32) {
        self.error_spread.pass(duration_s);
    }

    /// Forgets the fixes left out.
    pub(super) fn forget(&mut self) {
        self.rejected = 0;
        self.offset_m = 0.0;
    }

    /// Judges a fix by its innovation, m, and the innovation's variance.
    pub(super) fn judge<S: Scalar>(&mut self, innovation: S, variance: S) -> Verdict {
        let offset_m = innovation.to_f32();
        let normalised = offset_m * offset_m / variance.to_f32();
        self.spread.learn(normalised);
        if normalised <= LIMIT {
            self.error_spread.learn(offset_m / variance.sqrt().to_f32());
            self.forget();
            return Verdict::Fuse;
        }
        self.error_spread.interrupt();
        let agrees = (offset_m - self.offset_m).abs() <= AGREEMENT * offset_m.abs();
        self.rejected = if agrees {
            self.rejected.saturating_add(1)
        } else {
            1
        };
        self.offset_m = offset_m;
        if self.rejected < PATIENCE {
            return Verdict::Reject;
        }
        self.forget();
        Verdict::Reopen(offset_m)
    }
}
