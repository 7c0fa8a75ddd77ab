//! Brakes that no signal reports, found by a descent that does not show in the speed.
//!
//! A brake or a retarder that nobody reports makes a descent read as level. While the engine drives
//! nothing, the force balance gives only an upper bound of the slope: a brake can only make the
//! model read the road too high. Where GNSS then falls below the climb of the model, fix by fix, the
//! vehicle brakes, and goes on braking until the engine drives again. A receiver drifts by metres
//! within minutes, and not by several per cent of the distance.
//!
//! The test is a cumulative sum of the innovations (E. S. Page, "Continuous inspection schemes",
//! Biometrika 41:100, 1954): a brake moves many fixes by a little before it moves one by much.

use super::state::State;
use super::state_index::StateIndex::{Altitude, Bias, Slope, Wind};
use crate::cell::Condition;
use crate::context::Context;
use crate::sample::Sample;
use crate::scalar::Scalar;
use crate::vehicle::Traction;

/// Fall of an altitude, in sigmas beyond that of the steepest road, that is a step of the receiver; and
/// how low an altitude is at most where the step is over.
const JUMP_SIGMAS: f32 = 3.0;
const BACK_SIGMAS: f32 = 2.0;

/// Whether the vehicle brakes without a report.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct SilentBrake {
    /// Cells since the engine drives nothing.
    rolling_cells: u32,
    /// Sum of what altitudes were too low, in sigmas, and cells since it began.
    low_sum: f32,
    low_cells: u32,
    /// Altitude where it began, distance and climb of the model since, m.
    low_from_m: f32,
    length_m: f32,
    climb_m: f32,
    /// Error of the model when the engine last drove, %, and cells since it is larger.
    error_before: f32,
    larger_cells: u32,
    /// How low the last altitude was, m, and the distance since then, m.
    last_low_m: f32,
    since_fix_m: f32,
    /// Whether an altitude fell by more than a road does since altitudes were right.
    has_jumped: bool,
    is_on: bool,
    /// Brakes found on this drive that were not reported.
    found: u8,
}

impl SilentBrake {
    /// Returns the test for a second pass over the same drive: a brake that was not reported once is
    /// not reported before either.
    pub(super) fn second_pass(&self) -> Self {
        Self {
            found: self.found,
            ..Self::default()
        }
    }

    /// Returns whether brakes of this vehicle are known not to be reported. A single one may have
    /// been an error of altitudes.
    const fn is_known(&self) -> bool {
        self.found > 1
    }

    /// Returns whether the engine drives nothing over the newest cell.
    pub(super) const fn may_brake(&self) -> bool {
        self.rolling_cells > 0
    }

    /// Advances over a cell. Returns the sample as it is with the brake, if there is one.
    #[inline]
    pub(super) fn advance<S: Scalar>(
        &mut self,
        context: &Context,
        sample: &Sample,
        state: Option<&State<S>>,
    ) -> Option<Sample> {
        let forces = &sample.forces;
        let most = 0.01 * context.tuning.detection.silent_brake_traction_percent;
        // The braking of motors is part of a measured force.
        let is_measured = context.model.vehicle.traction == Traction::Force;
        if is_measured || forces.traction_n > most * forces.weight_n() {
            *self = Self {
                error_before: state.map_or(0.0, model_error),
                found: self.found,
                ..Self::default()
            };
            return None;
        }
        self.rolling_cells = self.rolling_cells.saturating_add(1);
        self.low_cells = self.low_cells.saturating_add(1);
        self.larger_cells = self.larger_cells.saturating_add(1);
        // What brakes without a report does so again.
        if !self.is_on && !self.is_known() {
            return None;
        }
        let mut braked = *sample;
        braked.end.condition = Condition {
            braking: true,
            ..sample.end.condition
        };
        Some(braked)
    }

    /// Adds a cell: its length, and its climb by the forces, m, from which the error of the model is
    /// taken.
    #[inline]
    pub(super) fn drive<S: Scalar>(&mut self, state: &State<S>, length_m: f32, climb_m: f32) {
        self.length_m += length_m;
        self.since_fix_m += length_m;
        self.climb_m += climb_m - 0.01 * length_m * model_error(state);
    }

    /// Takes an altitude, its innovation, m, and its variance. Returns the number of cells in
    /// which the brake was not noticed, if it is noticed now; the state is then widened.
    pub(super) fn fix<S: Scalar>(
        &mut self,
        context: &Context,
        sample: &Sample,
        state: &mut State<S>,
        (altitude_m, innovation_m, variance): (f32, f32, f32),
    ) -> Option<u32> {
        if self.rolling_cells == 0 || self.is_on || !sample.end.condition.is_valid() {
            return None;
        }
        let detection = &context.tuning.detection;
        let sigma_m = Scalar::sqrt(variance);
        let low_m = -innovation_m;
        let low = low_m / sigma_m;
        let steepest_m = 0.01 * detection.silent_brake_steepest_percent * self.since_fix_m;
        let fell_m = low_m - self.last_low_m;
        self.last_low_m = low_m;
        self.since_fix_m = 0.0;
        // The receiver stepped. Its gate moves the datum.
        self.has_jumped =
            fell_m > steepest_m + JUMP_SIGMAS * sigma_m || (self.has_jumped && low > BACK_SIGMAS);
        if self.has_jumped {
            self.low_sum = 0.0;
            return None;
        }
        // A single one may be an outlier.
        let counted = Scalar::min(
            low - detection.silent_brake_slack,
            detection.silent_brake_most,
        );
        self.low_sum = Scalar::max(self.low_sum + counted, 0.0);
        if self.low_sum <= 0.0 {
            self.low_cells = 0;
            self.low_from_m = altitude_m;
            self.length_m = 0.0;
            self.climb_m = 0.0;
        }
        let hidden_m = self.climb_m - (altitude_m - self.low_from_m);
        let hidden_percent = 100.0 * hidden_m / Scalar::max(self.length_m, sample.length_m);
        let slopes = detection.silent_brake_least_percent..detection.silent_brake_steepest_percent;
        let is_steep = slopes.contains(&hidden_percent);
        // Half of it shows a second one.
        let enough = detection.silent_brake_sum * if self.found > 0 { 0.5 } else { 1.0 };
        let is_low = self.low_sum > enough && is_steep;
        // Where the error of the model could move, it took in what the brake hides.
        let taken_in = Scalar::max(model_error(state) - self.error_before, 0.0);
        if taken_in < 0.5 * slopes.start {
            self.larger_cells = 0;
        }
        let beyond = taken_in - slopes.start;
        let has_taken_in = beyond > 0.0
            && beyond * beyond > 4.0 * model_error_variance(state)
            && hidden_percent < slopes.end;
        if !is_low && !has_taken_in {
            return None;
        }
        self.is_on = true;
        self.found = self.found.saturating_add(if has_taken_in { 2 } else { 1 });
        let steepest = detection.silent_brake_slope_percent;
        let covariance = &mut state.covariance;
        covariance.add_variance(Slope, S::from_f32(steepest * steepest));
        covariance.add_variance(Bias, S::from_f32(taken_in * taken_in));
        covariance.add_variance(Altitude, S::from_f32(innovation_m * innovation_m));
        let unnoticed_cells = if has_taken_in {
            self.larger_cells.max(self.low_cells)
        } else {
            self.low_cells
        };
        Some(unnoticed_cells.min(self.rolling_cells))
    }
}

/// Returns the slow error of the model, %.
fn model_error<S: Scalar>(state: &State<S>) -> f32 {
    (state.mean[Bias] + state.mean[Wind]).to_f32()
}

/// Returns its variance, %².
fn model_error_variance<S: Scalar>(state: &State<S>) -> f32 {
    let of = |i, j| state.covariance.get(i, j).to_f32();
    of(Bias, Bias) + 2.0 * of(Bias, Wind) + of(Wind, Wind)
}
