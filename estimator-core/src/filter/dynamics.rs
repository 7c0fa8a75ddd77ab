//! How the states move over one cell, without noise and input: the transition matrix F.
//!
//! F is a handful of shears, `x_i += factor * x_j`, and of factors on single states. Each acts on a
//! vector or, by rows and columns, on a symmetric matrix. Written so, a step costs a fraction of
//! two dense products.

use super::covariance::Covariance;
use super::quantity::Quantity;
use super::state::State;
use super::state_index::StateIndex::{
    Altitude, Bias, GnssError, KineticEnergy, Scale, Slope, SlopeRate, Wind,
};
use super::state_index::{StateIndex, StateVector};
use crate::scalar::Scalar;

/// Coefficients of F. The smoother needs no more of them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dynamics<S> {
    /// Half the length of the step, m.
    pub(crate) half_length: S,
    /// Part of the kinetic energy that air resistance leaves, 1.
    pub(crate) keep_energy: S,
    /// Net traction at the end of the cell, % ([`State::net_traction`]).
    pub(crate) net_traction: S,
    /// Part of its change that no road can have caused, %.
    pub(crate) traction_jump: S,
    /// Specific weight times length, m²/s² for 1 % of slope.
    pub(crate) gravity: S,
    /// Part of the slope rate that is left after the cell, 1.
    pub(crate) keep_slope_rate: S,
    /// Part of the bias that is left, 1.
    pub(crate) keep_bias: S,
    /// Part of the wind that is left, 1.
    pub(crate) keep_wind: S,
    /// Part of the coloured GNSS error that is left, 1.
    pub(crate) keep_gnss_error: S,
}

impl<S: Scalar> Dynamics<S> {
    /// Returns the dynamics of a cell before which the vehicle lost its net traction, %
    /// ([`State::release_traction`]).
    pub(super) fn after_release(&self, net_traction: S) -> Self {
        Self {
            traction_jump: self.traction_jump - net_traction,
            ..*self
        }
    }

    /// Applies F to mean and covariance.
    #[inline]
    pub(super) fn forward(&self, state: &mut State<S>) {
        self.forward_on(&mut state.mean);
        self.forward_on(&mut state.covariance);
        state.net_traction = self.net_traction;
    }

    /// Applies F to a vector.
    #[inline]
    pub(crate) fn forward_vector(&self, vector: &mut StateVector<S>) {
        self.forward_on(vector);
    }

    /// Applies F' to an adjoint vector.
    #[inline]
    pub(crate) fn transpose_vector(&self, vector: &mut StateVector<S>) {
        self.transpose_on(vector);
    }

    /// Applies F' Λ F to an information matrix.
    #[inline]
    pub(crate) fn transpose_matrix(&self, information: &mut Covariance<S>) {
        self.transpose_on(information);
    }

    // Written out instead of loops, so that the compiler knows every index. Otherwise it computes
    // positions in the packed triangle again and again, and checks them.

    #[inline(always)]
    fn forward_on(&self, target: &mut impl Sheared<S>) {
        if self.has_jump() {
            target.shear(self.traction_step());
        }
        target.shear(self.half_turn());
        target.shear(self.weight());
        target.climb(self.climb(), self.net_traction);
        target.shear(self.half_turn());
        self.decay_on(target);
    }

    #[inline(always)]
    fn transpose_on(&self, target: &mut impl Sheared<S>) {
        let climb = self.climb();
        self.decay_on(target);
        target.shear(self.half_turn().transposed());
        target.shear(Shear(Scale, Altitude, climb * self.net_traction));
        target.shear(Shear(Wind, Altitude, -climb));
        target.shear(Shear(Bias, Altitude, -climb));
        target.shear(Shear(Slope, Altitude, climb));
        target.shear(self.weight().transposed());
        target.shear(self.half_turn().transposed());
        if self.has_jump() {
            target.shear(self.traction_step().transposed());
        }
    }

    /// Returns whether the traction changed faster than a road bends, which is rare.
    #[inline(always)]
    fn has_jump(&self) -> bool {
        self.traction_jump != S::ZERO
    }

    #[inline(always)]
    fn decay_on(&self, target: &mut impl Sheared<S>) {
        let [a, b, c, d, e] = self.decays();
        target.scale(a);
        target.scale(b);
        target.scale(c);
        target.scale(d);
        target.scale(e);
    }

    /// The slope that the model reads steps by the scale's error.
    #[inline(always)]
    fn traction_step(&self) -> Shear<S> {
        Shear(Slope, Scale, -self.traction_jump)
    }

    /// The slope turns: half of it in the middle of the cell, so that energy and altitude see it.
    #[inline(always)]
    fn half_turn(&self) -> Shear<S> {
        Shear(Slope, SlopeRate, self.half_length)
    }

    /// The weight works along the slope that the model reads.
    #[inline(always)]
    fn weight(&self) -> Shear<S> {
        Shear(KineticEnergy, Slope, -self.gravity)
    }

    /// Returns the climb over the cell on a slope of 1 %, m.
    #[inline(always)]
    fn climb(&self) -> S {
        self.half_length * S::from_f32(0.02)
    }

    /// Returns the diagonal entries that are not one.
    ///
    /// They act after the shears: air resistance takes its part of the whole work of the weight, not
    /// of half of it, and none of the work of the other forces. The part is some thousandth in a
    /// cell, which is negligible.
    #[inline(always)]
    fn decays(&self) -> [(StateIndex, S); 5] {
        [
            (KineticEnergy, self.keep_energy),
            (SlopeRate, self.keep_slope_rate),
            (Bias, self.keep_bias),
            (Wind, self.keep_wind),
            (GnssError, self.keep_gnss_error),
        ]
    }
}

/// The shear `x_i += factor * x_j`.
#[derive(Clone, Copy)]
struct Shear<S>(StateIndex, StateIndex, S);

impl<S> Shear<S> {
    #[inline(always)]
    fn transposed(self) -> Self {
        let Self(i, j, factor) = self;
        Self(j, i, factor)
    }
}

/// What F acts on: a vector, or a symmetric matrix by rows and columns.
trait Sheared<S> {
    fn shear(&mut self, shear: Shear<S>);
    /// Applies `altitude += factor * slope of the road` ([`Quantity::Slope`]): four shears in one.
    fn climb(&mut self, factor: S, net_traction: S);
    /// Applies `x_i *= factor`.
    fn scale(&mut self, decay: (StateIndex, S));
}

impl<S: Scalar> Sheared<S> for StateVector<S> {
    #[inline(always)]
    fn shear(&mut self, Shear(i, j, factor): Shear<S>) {
        let source = self[j];
        self[i].add_product(factor, &source);
    }

    #[inline(always)]
    fn climb(&mut self, factor: S, net_traction: S) {
        let slope = Quantity::Slope.of(net_traction, |state| self[state]);
        self[Altitude] += factor * slope;
    }

    #[inline(always)]
    fn scale(&mut self, (i, factor): (StateIndex, S)) {
        self[i] *= factor;
    }
}

impl<S: Scalar> Sheared<S> for Covariance<S> {
    #[inline(always)]
    fn shear(&mut self, Shear(i, j, factor): Shear<S>) {
        Self::shear(self, i, j, factor);
    }

    #[inline(always)]
    fn climb(&mut self, factor: S, net_traction: S) {
        let cross = Quantity::Slope.cross(net_traction, self);
        let variance = Quantity::Slope.of(net_traction, |state| cross[state]);
        self.shear_by(Altitude, factor, &cross, variance);
    }

    #[inline(always)]
    fn scale(&mut self, (i, factor): (StateIndex, S)) {
        Self::scale(self, i, factor);
    }
}
