//! Steps of the slope that the model reads, which roads do not make.
//!
//! Snow begins, a power take-off is switched on, a gust hits: the force changes within metres, and
//! the model reads it as a slope that begins within metres. Innovations of the speed then have the
//! same sign over some ten cells. Both causes are allowed for: a kink of the road, and a step of the
//! model's error with the same step of the slope that it reads. The altitudes that follow decide.

use super::state::State;
use super::state_index::StateIndex::{Bias, Slope};
use crate::scalar::Scalar;
use crate::tuning::Gates;

/// Exponential sum of normalised innovations of the speed.
#[derive(Clone, Copy, Debug)]
pub(super) struct SlopeStep {
    sum: f32,
    /// Usual square of the sum over its variance, at least one: speeds may have noise of any colour.
    usual: f32,
    /// Cells until the next step may be found.
    rest_cells: u16,
}

impl SlopeStep {
    /// Creates the sum before the first innovation.
    pub(super) const fn new(tuning: &Gates) -> Self {
        Self {
            sum: 0.0,
            usual: 1.0,
            rest_cells: tuning.slope_step_first_cells,
        }
    }

    /// Drops the sum: the next innovation does not follow the last one.
    pub(super) fn restart(&mut self) {
        self.sum = 0.0;
    }

    /// Takes a normalised innovation. Returns whether the slope stepped.
    pub(super) fn add(&mut self, innovation: f32, tuning: &Gates) -> bool {
        let keep = 1.0 - 1.0 / tuning.slope_step_cells;
        self.sum = keep * self.sum + Scalar::min(3.0, Scalar::max(-3.0, innovation));
        let squared = self.sum * self.sum * (1.0 - keep * keep);
        let limit = tuning.slope_step_sigmas * tuning.slope_step_sigmas * self.usual;
        let followed = Scalar::min(squared / self.usual, tuning.slope_step_largest) - 1.0;
        let factor = 1.0 + tuning.slope_step_gain * followed;
        self.usual = Scalar::max(1.0, self.usual * factor);
        if self.rest_cells > 0 {
            self.rest_cells -= 1;
            return false;
        }
        let is_step = squared > limit;
        if is_step {
            self.sum = 0.0;
            self.rest_cells = tuning.slope_step_rest_cells;
        }
        is_step
    }
}

/// Allows for a step of the slope, by the road or by the model.
pub(super) fn allow_step<S: Scalar>(state: &mut State<S>, tuning: &Gates) {
    let variance = S::from_f32(tuning.slope_step_percent * tuning.slope_step_percent);
    let covariance = &mut state.covariance;
    covariance.add_variance(Bias, variance);
    covariance.add_variance(Slope, variance + variance);
    let joint = covariance.get(Slope, Bias) + variance;
    covariance.set(Slope, Bias, joint);
}

/// Allows for a kink of the road that altitudes alone did not show: the model tests what they say of
/// the slope, and not its own bias by it.
pub(super) fn allow_kink<S: Scalar>(state: &mut State<S>, tuning: &Gates) {
    let variance = S::from_f32(tuning.slope_step_percent * tuning.slope_step_percent);
    state.covariance.add_variance(Slope, variance + variance);
}
