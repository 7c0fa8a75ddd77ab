//! How the states move over one cell, without noise and input: a few shears.

use super::covariance::Covariance;
use super::state::{
    ALTITUDE, BIAS, ENERGY, GNSS_ERROR, SCALE, SLOPE, SLOPE_RATE, STATES, State, WIND,
};
use crate::scalar::Scalar;

/// Coefficients of the linear step: all of it that the smoother needs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Motion<S> {
    /// Length of the step, m.
    pub(super) length: S,
    /// Part of the kinetic energy that air resistance leaves.
    pub(super) keep_energy: S,
    /// Traction less air resistance over weight at the end of the cell, % ([`State::load`]).
    pub(super) load: S,
    /// What of its change no road can have caused, %.
    pub(super) load_jump: S,
    /// Specific weight times length, m²/s² for 1 %.
    pub(super) gravity: S,
    /// Part of the slope rate that is left.
    pub(super) keep_rate: S,
    /// Part of the bias that is left.
    pub(super) keep_bias: S,
    /// Part of the wind that is left.
    pub(super) keep_wind: S,
    /// Part of the coloured GNSS error that is left.
    pub(super) keep_gnss_error: S,
}

impl<S: Scalar> Motion<S> {
    /// Moves mean and covariance.
    #[inline]
    pub(super) fn forward(&self, state: &mut State<S>) {
        for (i, j, factor) in self.shears() {
            let step = factor * state.x[j];
            state.x[i] += step;
            state.p.shear(i, j, factor);
        }
        for (i, keep) in self.keeps() {
            state.x[i] *= keep;
            state.p.scale(i, keep);
        }
        state.load = self.load;
    }

    /// Moves a mean alone.
    #[inline]
    pub(super) fn forward_vector(&self, vector: &mut [S; STATES]) {
        for (i, j, factor) in self.shears() {
            let step = factor * vector[j];
            vector[i] += step;
        }
        for (i, keep) in self.keeps() {
            vector[i] *= keep;
        }
    }

    /// The transposed step on a vector of the smoother's: backwards.
    #[inline]
    pub(super) fn transpose_vector(&self, vector: &mut [S; STATES]) {
        for (i, keep) in self.keeps() {
            vector[i] *= keep;
        }
        for (i, j, factor) in self.shears().into_iter().rev() {
            let step = factor * vector[i];
            vector[j] += step;
        }
    }

    /// The transposed step on its matrix.
    #[inline]
    pub(super) fn transpose_matrix(&self, information: &mut Covariance<S>) {
        for (i, keep) in self.keeps() {
            information.scale(i, keep);
        }
        for (i, j, factor) in self.shears().into_iter().rev() {
            information.shear(j, i, factor);
        }
    }

    /// Off-diagonal entries of the transition as `x_i += factor * x_j`, in order. The slope turns
    /// halfway through the cell, so that energy and altitude see its middle.
    #[inline(always)]
    fn shears(&self) -> [(usize, usize, S); 8] {
        let half = self.length * S::from_f32(0.5);
        let climb = self.length * S::from_f32(0.01);
        [
            (SLOPE, SCALE, -self.load_jump),
            (SLOPE, SLOPE_RATE, half),
            (ENERGY, SLOPE, -self.gravity),
            (ALTITUDE, SLOPE, climb),
            (ALTITUDE, BIAS, -climb),
            (ALTITUDE, WIND, -climb),
            (ALTITUDE, SCALE, climb * self.load),
            (SLOPE, SLOPE_RATE, half),
        ]
    }

    /// Diagonal entries that are not one.
    ///
    /// They act after the shears; the forces of the cell thus lose to air resistance a part in a
    /// thousand of what the energy does, which is nothing.
    #[inline(always)]
    fn keeps(&self) -> [(usize, S); 5] {
        [
            (ENERGY, self.keep_energy),
            (SLOPE_RATE, self.keep_rate),
            (BIAS, self.keep_bias),
            (WIND, self.keep_wind),
            (GNSS_ERROR, self.keep_gnss_error),
        ]
    }
}
