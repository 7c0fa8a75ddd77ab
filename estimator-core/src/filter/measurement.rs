//! Scalar measurements: the rows h of the measurement matrix, and the update with one of them.

use super::covariance::Covariance;
use super::state::State;
use super::state_index::StateIndex::{Altitude, GnssError, KineticEnergy, Scale};
use super::state_index::StateVector;
use crate::scalar::Scalar;

/// The row h of a measurement: a sum of states.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Observation {
    /// v²/2 of the wheel speed: h x = e.
    Energy,
    /// GNSS altitude: h x = z + g.
    Altitude,
    /// The scale as it was before a stop: h x = κ.
    Scale,
}

/// A scalar measurement: its row, its innovation and its noise.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ScalarMeasurement<S> {
    /// The row h.
    pub observation: Observation,
    /// Innovation ν: measured minus predicted.
    pub innovation: S,
    /// Variance R of the measurement noise.
    pub variance: S,
}

/// A scalar update that was applied. The smoother needs it to go back over the measurement.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ScalarUpdate<S> {
    /// Innovation ν.
    pub innovation: S,
    /// Innovation variance S = h P h' + R.
    pub innovation_variance: S,
    /// Gain K = P h' / S.
    pub gain: StateVector<S>,
}

impl<S: Scalar> ScalarUpdate<S> {
    /// Applies v ← (I − K h)' v to an adjoint vector.
    #[inline]
    pub(crate) fn transpose_vector(&self, observation: Observation, vector: &mut StateVector<S>) {
        observation.add_to(vector, -self.gain.dot(vector));
    }

    /// Returns the normalised squared innovation ν²/S.
    #[inline]
    #[must_use]
    pub fn normalised_squared(&self) -> S {
        self.innovation.squared() / self.innovation_variance
    }
}

impl Observation {
    /// Returns h x.
    #[inline(always)]
    #[must_use]
    pub fn of<S: Scalar>(self, x: &StateVector<S>) -> S {
        match self {
            Self::Energy => x[KineticEnergy],
            Self::Altitude => x[Altitude] + x[GnssError],
            Self::Scale => x[Scale],
        }
    }

    /// Applies `v += factor * h'`.
    #[inline(always)]
    pub(crate) fn add_to<S: Scalar>(self, vector: &mut StateVector<S>, factor: S) {
        match self {
            Self::Energy => vector[KineticEnergy] += factor,
            Self::Altitude => {
                vector[Altitude] += factor;
                vector[GnssError] += factor;
            }
            Self::Scale => vector[Scale] += factor,
        }
    }

    /// Returns P h'.
    #[inline(always)]
    pub(super) fn cross<S: Scalar>(self, p: &Covariance<S>) -> StateVector<S> {
        match self {
            Self::Energy => p.row(KineticEnergy),
            Self::Scale => p.row(Scale),
            Self::Altitude => {
                let mut sum = p.row(Altitude);
                for (k, element) in sum.0.iter_mut().enumerate() {
                    *element += p.element(GnssError as usize, k);
                }
                sum
            }
        }
    }

    /// Applies `M += f h' h - h' b - b' h`. Only what the measurement observes changes.
    #[inline(always)]
    pub(crate) fn add_products<S: Scalar>(
        self,
        matrix: &mut Covariance<S>,
        b: &StateVector<S>,
        factor: S,
    ) {
        match self {
            Self::Energy => matrix.add_observation_products([KineticEnergy], b, factor),
            Self::Altitude => matrix.add_observation_products([Altitude, GnssError], b, factor),
            Self::Scale => matrix.add_observation_products([Scale], b, factor),
        }
    }
}

impl<S: Scalar> ScalarMeasurement<S> {
    /// Updates the state with the measurement.
    #[inline]
    pub fn apply(&self, state: &mut State<S>) -> ScalarUpdate<S> {
        let cross = self.observation.cross(&state.covariance);
        let innovation_variance = self.observation.of(&cross) + self.variance;
        let per_variance = S::ONE / innovation_variance;
        let gain = StateVector(cross.0.map(|element| element * per_variance));
        for (x, gain) in state.mean.0.iter_mut().zip(&gain.0) {
            x.add_product(self.innovation, gain);
        }
        state.covariance.reduce(&gain, &cross);
        if self.observation == Observation::Energy {
            // The covariance of a state that is observed alone, without the difference of two large
            // numbers: after a step of the speed it shrinks by a factor of a million.
            state
                .covariance
                .set_row(KineticEnergy, |k| gain.0[k] * self.variance);
        }
        ScalarUpdate {
            innovation: self.innovation,
            innovation_variance,
            gain,
        }
    }
}
