//! How the states move over one cell: the transition matrix F as elementary shears.

use super::covariance::{Covariance, StateVector};
use super::state_index::StateIndex::{
    self, Altitude, Bias, DoubtfulForce, FastGnssError, KineticEnergy, Retarder, Scale, Slope,
    SlopeRate, SlowGnssError, Wind,
};
use crate::cell::CELL_LENGTH_M;
use crate::scalar::Scalar;

/// Coefficients of F.
#[derive(Clone, Copy, Debug)]
pub struct Dynamics<S> {
    /// Fraction of the kinetic energy that air resistance leaves, 1.
    pub keep_energy: S,
    /// Specific weight times length, m²/s² for 1 % of slope.
    pub gravity: S,
    /// Net traction, %: the slope that an error of the scale amounts to.
    pub net_traction: S,
    /// Change of the net traction that no road can have caused, %.
    pub traction_jump: S,
    /// Force of the retarder as a slope, %.
    pub retarder: S,
    /// Its change since the last cell, %.
    pub retarder_step: S,
    /// Fraction of the slope rate that is left after the cell.
    pub keep_slope_rate: S,
    /// Fraction of the bias that is left.
    pub keep_bias: S,
    /// Fraction of the wind that is left.
    pub keep_wind: S,
    /// Fraction of the slow GNSS error that is left.
    pub keep_slow_gnss_error: S,
    /// Fraction of the fast GNSS error that is left.
    pub keep_fast_gnss_error: S,
    /// Whether the doubtful force ends before this cell.
    pub ends_doubt: bool,
}

const HALF_LENGTH_M: f32 = 0.5 * CELL_LENGTH_M;
/// Climb over the cell on a slope of 1 %, m.
const CLIMB_M: f32 = 0.01 * CELL_LENGTH_M;

/// What F acts on: a vector, or a symmetric matrix by rows and columns.
trait Sheared<S> {
    fn shear(&mut self, i: StateIndex, j: StateIndex, factor: S);
    fn scale(&mut self, i: StateIndex, factor: S);
    fn clear(&mut self, i: StateIndex);
}

impl<S: Scalar> Sheared<S> for StateVector<S> {
    #[inline(always)]
    fn shear(&mut self, i: StateIndex, j: StateIndex, factor: S) {
        let source = self[j as usize];
        self[i as usize].add_product(factor, &source);
    }

    #[inline(always)]
    fn scale(&mut self, i: StateIndex, factor: S) {
        self[i as usize] *= factor;
    }

    #[inline(always)]
    fn clear(&mut self, i: StateIndex) {
        self[i as usize] = S::ZERO;
    }
}

impl<S: Scalar> Sheared<S> for Covariance<S> {
    #[inline(always)]
    fn shear(&mut self, i: StateIndex, j: StateIndex, factor: S) {
        Self::shear(self, i, j, factor);
    }

    #[inline(always)]
    fn scale(&mut self, i: StateIndex, factor: S) {
        Self::scale(self, i, factor);
    }

    #[inline(always)]
    fn clear(&mut self, i: StateIndex) {
        Self::clear(self, i);
    }
}

impl<S: Scalar> Dynamics<S> {
    /// Applies F to mean and covariance.
    #[inline(always)]
    pub fn forward(&self, mean: &mut StateVector<S>, covariance: &mut Covariance<S>) {
        self.forward_on(mean);
        self.forward_on(covariance);
    }

    /// Applies F to a vector.
    pub fn forward_vector(&self, vector: &mut StateVector<S>) {
        self.forward_on(vector);
    }

    /// Applies F' to an adjoint vector, and F' N F to its information matrix.
    #[inline(always)]
    pub fn transpose(&self, vector: &mut StateVector<S>, information: &mut Covariance<S>) {
        self.transpose_on(vector);
        self.transpose_on(information);
    }

    #[inline(always)]
    fn forward_on(&self, target: &mut impl Sheared<S>) {
        if self.ends_doubt {
            target.shear(Slope, DoubtfulForce, -S::ONE);
            target.clear(DoubtfulForce);
        }
        if self.traction_jump != S::ZERO {
            target.shear(Slope, Scale, -self.traction_jump);
        }
        if self.retarder_step != S::ZERO {
            target.shear(Slope, Retarder, self.retarder_step);
        }
        let half = S::from_f32(HALF_LENGTH_M);
        let climb = S::from_f32(CLIMB_M);
        target.shear(Slope, SlopeRate, half);
        target.shear(KineticEnergy, Slope, -self.gravity);
        target.shear(Altitude, Slope, climb);
        target.shear(Altitude, Bias, -climb);
        target.shear(Altitude, Wind, -climb);
        if !self.ends_doubt {
            target.shear(Altitude, DoubtfulForce, -climb);
        }
        target.shear(Altitude, Scale, climb * self.net_traction);
        if self.retarder != S::ZERO {
            target.shear(Altitude, Retarder, -(climb * self.retarder));
        }
        target.shear(Slope, SlopeRate, half);
        self.decay_on(target);
    }

    #[inline(always)]
    fn transpose_on(&self, target: &mut impl Sheared<S>) {
        let half = S::from_f32(HALF_LENGTH_M);
        let climb = S::from_f32(CLIMB_M);
        self.decay_on(target);
        target.shear(SlopeRate, Slope, half);
        if self.retarder != S::ZERO {
            target.shear(Retarder, Altitude, -(climb * self.retarder));
        }
        target.shear(Scale, Altitude, climb * self.net_traction);
        if !self.ends_doubt {
            target.shear(DoubtfulForce, Altitude, -climb);
        }
        target.shear(Wind, Altitude, -climb);
        target.shear(Bias, Altitude, -climb);
        target.shear(Slope, Altitude, climb);
        target.shear(Slope, KineticEnergy, -self.gravity);
        target.shear(SlopeRate, Slope, half);
        if self.retarder_step != S::ZERO {
            target.shear(Retarder, Slope, self.retarder_step);
        }
        if self.traction_jump != S::ZERO {
            target.shear(Scale, Slope, -self.traction_jump);
        }
        if self.ends_doubt {
            target.clear(DoubtfulForce);
            target.shear(DoubtfulForce, Slope, -S::ONE);
        }
    }

    /// The diagonal entries act after the shears: air resistance takes its fraction of the whole work
    /// of the weight.
    #[inline(always)]
    fn decay_on(&self, target: &mut impl Sheared<S>) {
        target.scale(KineticEnergy, self.keep_energy);
        target.scale(SlopeRate, self.keep_slope_rate);
        target.scale(Bias, self.keep_bias);
        target.scale(Wind, self.keep_wind);
        target.scale(SlowGnssError, self.keep_slow_gnss_error);
        target.scale(FastGnssError, self.keep_fast_gnss_error);
    }
}
