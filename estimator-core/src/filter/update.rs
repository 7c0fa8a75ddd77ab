//! One scalar measurement.

use super::covariance::Covariance;
use super::state::{ALTITUDE, ENERGY, GNSS_ERROR, STATES, State};
use crate::scalar::Scalar;

/// What a measurement sees of the state: a sum of states.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Observation {
    /// v²/2 of the wheel speed.
    Energy,
    /// GNSS altitude: altitude plus its coloured error.
    Altitude,
}

/// A measurement to be taken in: its innovation and variance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Update<S> {
    /// What was seen.
    pub observation: Observation,
    /// Measured minus predicted.
    pub innovation: S,
    /// Variance of the measurement.
    pub variance: S,
}

/// A measurement taken in: what the smoother needs to go back over it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Applied<S> {
    /// Measured minus predicted.
    pub innovation: S,
    /// Variance of the innovation.
    pub innovation_variance: S,
    /// The gain.
    pub gain: [S; STATES],
}

impl<S: Scalar> Applied<S> {
    /// v ← (I − K h)' v, for the smoother.
    #[inline]
    pub(super) fn undo(&self, observation: Observation, vector: &mut [S; STATES]) {
        observation.add_to(vector, -S::dot(&self.gain, vector));
    }
}

impl Observation {
    /// h x.
    #[inline(always)]
    #[must_use]
    pub fn of<S: Scalar>(self, x: &[S; STATES]) -> S {
        match self {
            Self::Energy => x[ENERGY],
            Self::Altitude => x[ALTITUDE] + x[GNSS_ERROR],
        }
    }

    /// `v += factor * h'`.
    #[inline(always)]
    pub(super) fn add_to<S: Scalar>(self, vector: &mut [S; STATES], factor: S) {
        match self {
            Self::Energy => vector[ENERGY] += factor,
            Self::Altitude => {
                vector[ALTITUDE] += factor;
                vector[GNSS_ERROR] += factor;
            }
        }
    }

    /// P h'.
    #[inline(always)]
    pub(super) fn cross<S: Scalar>(self, p: &Covariance<S>) -> [S; STATES] {
        match self {
            Self::Energy => p.row(ENERGY),
            Self::Altitude => {
                let mut sum = p.row(ALTITUDE);
                for (k, element) in sum.iter_mut().enumerate() {
                    *element += p.get(GNSS_ERROR, k);
                }
                sum
            }
        }
    }

    /// `M + f h' h - h' b - b' h`: only what the measurement sees changes.
    #[inline(always)]
    pub(super) fn add_products<S: Scalar>(
        self,
        matrix: &mut Covariance<S>,
        b: &[S; STATES],
        factor: S,
    ) {
        match self {
            Self::Energy => add_products(matrix, [ENERGY], b, factor),
            Self::Altitude => add_products(matrix, [ALTITUDE, GNSS_ERROR], b, factor),
        }
    }
}

/// The same, with the states that h sums.
#[inline(always)]
fn add_products<S: Scalar, const SEEN: usize>(
    matrix: &mut Covariance<S>,
    seen: [usize; SEEN],
    b: &[S; STATES],
    factor: S,
) {
    let at = |i: usize| b.get(i).copied().unwrap_or(S::ZERO);
    for (n, i) in seen.into_iter().enumerate() {
        for (k, element) in b.iter().enumerate() {
            if !seen.contains(&k) {
                matrix.set(i, k, matrix.get(i, k) - *element);
            }
        }
        for j in seen.into_iter().skip(n) {
            matrix.set(i, j, matrix.get(i, j) + (factor - at(j) - at(i)));
        }
    }
}

impl<S: Scalar> Update<S> {
    /// Applies it.
    #[inline]
    pub fn apply(&self, state: &mut State<S>) -> Applied<S> {
        let cross = self.observation.cross(&state.p);
        let innovation_variance = self.observation.of(&cross) + self.variance;
        let per_variance = S::ONE / innovation_variance;
        let gain = cross.map(|element| element * per_variance);
        for (x, gain) in state.x.iter_mut().zip(&gain) {
            x.add_product(self.innovation, gain);
        }
        state.p.reduce(&gain, &cross);
        if self.observation == Observation::Energy {
            // What is left of a state seen alone, without the difference of two large numbers: a
            // speed that steps is known a million times better than before.
            for (k, gain) in gain.iter().enumerate() {
                state.p.set(ENERGY, k, *gain * self.variance);
            }
        }
        Applied {
            innovation: self.innovation,
            innovation_variance,
            gain,
        }
    }
}
