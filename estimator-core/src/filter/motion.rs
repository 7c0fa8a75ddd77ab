//! How the states move over one cell, without noise and input: a few shears.

use super::covariance::Covariance;
use super::state::{
    ALTITUDE, BIAS, ENERGY, GNSS_ERROR, Quantity, SCALE, SLOPE, SLOPE_RATE, STATES, State, WIND,
};
use crate::scalar::Scalar;

/// Coefficients of the linear step: all of it that the smoother needs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Motion<S> {
    /// Half the length of the step, m.
    pub(super) half_length: S,
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
        self.forward_on(&mut state.x);
        self.forward_on(&mut state.p);
        state.load = self.load;
    }

    /// Moves a mean alone.
    #[inline]
    pub(super) fn forward_vector(&self, vector: &mut [S; STATES]) {
        self.forward_on(vector);
    }

    /// The transposed step on a vector of the smoother's: backwards.
    #[inline]
    pub(super) fn transpose_vector(&self, vector: &mut [S; STATES]) {
        self.transpose_on(vector);
    }

    /// The transposed step on its matrix.
    #[inline]
    pub(super) fn transpose_matrix(&self, information: &mut Covariance<S>) {
        self.transpose_on(information);
    }

    // Written out and not as loops, so that the compiler knows every index: else it computes
    // places in the packed triangle again and again, and checks them.

    #[inline(always)]
    fn forward_on(&self, moved: &mut impl Sheared<S>) {
        if self.jumps() {
            moved.shear(self.load_step());
        }
        moved.shear(self.half_turn());
        moved.shear(self.weight());
        moved.climb(self.climb(), self.load);
        moved.shear(self.half_turn());
        self.keep_on(moved);
    }

    #[inline(always)]
    fn transpose_on(&self, moved: &mut impl Sheared<S>) {
        let climb = self.climb();
        self.keep_on(moved);
        moved.shear(self.half_turn().transposed());
        moved.shear(Shear(SCALE, ALTITUDE, climb * self.load));
        moved.shear(Shear(WIND, ALTITUDE, -climb));
        moved.shear(Shear(BIAS, ALTITUDE, -climb));
        moved.shear(Shear(SLOPE, ALTITUDE, climb));
        moved.shear(self.weight().transposed());
        moved.shear(self.half_turn().transposed());
        if self.jumps() {
            moved.shear(self.load_step().transposed());
        }
    }

    /// Whether the load changed as no road makes it: seldom.
    #[inline(always)]
    fn jumps(&self) -> bool {
        self.load_jump != S::ZERO
    }

    #[inline(always)]
    fn keep_on(&self, moved: &mut impl Sheared<S>) {
        let [a, b, c, d, e] = self.keeps();
        moved.scale(a);
        moved.scale(b);
        moved.scale(c);
        moved.scale(d);
        moved.scale(e);
    }

    /// The slope that is read steps by the scale's error.
    #[inline(always)]
    fn load_step(&self) -> Shear<S> {
        Shear(SLOPE, SCALE, -self.load_jump)
    }

    /// The slope turns, half in the middle of the cell, so that energy and altitude see that.
    #[inline(always)]
    fn half_turn(&self) -> Shear<S> {
        Shear(SLOPE, SLOPE_RATE, self.half_length)
    }

    #[inline(always)]
    fn weight(&self) -> Shear<S> {
        Shear(ENERGY, SLOPE, -self.gravity)
    }

    /// What a slope of the road becomes in altitude, m for 1 %.
    #[inline(always)]
    fn climb(&self) -> S {
        self.half_length * S::from_f32(0.02)
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

/// `x_i += factor * x_j`.
#[derive(Clone, Copy)]
struct Shear<S>(usize, usize, S);

impl<S> Shear<S> {
    #[inline(always)]
    fn transposed(self) -> Self {
        let Self(i, j, factor) = self;
        Self(j, i, factor)
    }
}

/// What a motion moves: a vector, or a symmetric matrix by rows and columns.
trait Sheared<S> {
    fn shear(&mut self, shear: Shear<S>);
    /// `altitude += factor * slope of the road` ([`Quantity::Slope`]): four shears in one.
    fn climb(&mut self, factor: S, load: S);
    /// `x_i *= factor`.
    fn scale(&mut self, keep: (usize, S));
}

impl<S: Scalar> Sheared<S> for [S; STATES] {
    #[inline(always)]
    fn shear(&mut self, Shear(i, j, factor): Shear<S>) {
        let moving = self[j];
        self[i].add_product(factor, &moving);
    }

    #[inline(always)]
    fn climb(&mut self, factor: S, load: S) {
        let slope = Quantity::Slope.of(load, |i| self[i]);
        self[ALTITUDE] += factor * slope;
    }

    #[inline(always)]
    fn scale(&mut self, (i, factor): (usize, S)) {
        self[i] *= factor;
    }
}

impl<S: Scalar> Sheared<S> for Covariance<S> {
    #[inline(always)]
    fn shear(&mut self, Shear(i, j, factor): Shear<S>) {
        Self::shear(self, i, j, factor);
    }

    #[inline(always)]
    fn climb(&mut self, factor: S, load: S) {
        let cross = Quantity::Slope.cross(load, self);
        let variance = Quantity::Slope.of(load, |i| cross[i]);
        self.shear_by(ALTITUDE, factor, &cross, variance);
    }

    #[inline(always)]
    fn scale(&mut self, (i, factor): (usize, S)) {
        Self::scale(self, i, factor);
    }
}
