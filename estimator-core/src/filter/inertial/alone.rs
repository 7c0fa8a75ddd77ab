//! Stretches over which the accelerometer stands in for the force model.
//!
//! Its noise is that of the prediction there. Its slow errors are the same in all cells of a stretch.
//! Over a long one they matter more than the noise: the slope that is read moves by them, and that of
//! the road does not. So slope and bias gain a variance that they share, where the source of the slope
//! changes.

use super::super::state::State;
use super::super::state_index::StateIndex::{Altitude, Bias, Slope};
use crate::scalar::Scalar;
use crate::tuning::Inertial;
use crate::vehicle::GRAVITY;

/// Slope that an acceleration of 1 m/s² amounts to, %.
pub(super) const PERCENT_PER_MPS2: f32 = 100.0 / GRAVITY;

/// Such a stretch, and the part of the errors that the state does not contain yet.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Alone {
    /// Its length up to the last cell, m.
    length_m: f32,
    /// Variance that the slope that is read shares with the bias, %².
    shared: f32,
    /// Variance of the slope alone, %².
    slope: f32,
    /// Variance of the altitude, m².
    altitude: f32,
    /// Variance by which the accelerometer may be wrong while the force is not believed, %².
    doubted: f32,
}

impl Alone {
    /// Returns whether the accelerometer stands in.
    pub(super) fn is_on(&self) -> bool {
        self.length_m > 0.0
    }

    /// Notes the part of the prediction over a cell that is the accelerometer's, whose slow errors
    /// make it wrong by this variance, (m/s²)².
    pub(super) fn follow(&mut self, weight: f32, variance: f32, length_m: f32, tuning: &Inertial) {
        if weight < 0.5 {
            self.end(variance, tuning);
            return;
        }
        let was_long = self.length_m >= tuning.alone_m;
        self.length_m += length_m;
        if !was_long && self.length_m >= tuning.alone_m {
            self.change_source(variance);
        }
    }

    /// Ends a stretch: the slope is read by the force again.
    pub(super) fn end(&mut self, variance: f32, tuning: &Inertial) {
        if self.length_m >= tuning.alone_m {
            self.change_source(variance);
        }
        self.length_m = 0.0;
    }

    /// Notes that the force has been wrong over a length, at last by an error in m/s².
    pub(super) fn doubt(&mut self, error_mps2: f32, length_m: f32, tuning: &Inertial) {
        let percent = PERCENT_PER_MPS2 * error_mps2;
        let part = tuning.doubt * percent;
        let climb_m = 0.5 * 0.01 * percent * length_m;
        self.doubted = part * part;
        self.shared += self.doubted;
        self.slope += percent * percent;
        self.altitude += climb_m * climb_m;
    }

    /// Notes that the force is read again after a doubt.
    pub(super) fn believe(&mut self) {
        self.shared += core::mem::take(&mut self.doubted);
    }

    fn change_source(&mut self, variance: f32) {
        self.shared += variance * PERCENT_PER_MPS2 * PERCENT_PER_MPS2;
    }

    /// Widens a state by the part of the errors that it does not contain yet.
    #[inline]
    pub(super) fn widen<S: Scalar>(&mut self, state: &mut State<S>) {
        if self.shared + self.slope <= 0.0 {
            return;
        }
        self.widen_by_all(state);
    }

    #[inline(never)] // Rare.
    fn widen_by_all<S: Scalar>(&mut self, state: &mut State<S>) {
        let covariance = &mut state.covariance;
        let shared = S::from_f32(core::mem::take(&mut self.shared));
        let slope = S::from_f32(core::mem::take(&mut self.slope));
        let altitude = S::from_f32(core::mem::take(&mut self.altitude));
        let joint = covariance.get(Slope, Bias) + shared;
        covariance.set(Slope, Bias, joint);
        covariance.add_variance(Bias, shared);
        covariance.add_variance(Slope, shared + slope);
        covariance.add_variance(Altitude, altitude);
    }
}
