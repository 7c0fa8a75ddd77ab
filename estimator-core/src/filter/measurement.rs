//! Scalar measurements: the rows h of the measurement matrix, and the update with one of them.

use super::covariance::Covariance;
use super::state::State;
use super::state_index::StateIndex::{
    Altitude, Bias, GnssError, KineticEnergy, Scale, Slope, Wind,
};
use super::state_index::StateVector;
use crate::scalar::Scalar;

/// The row h of a measurement: a sum of states.
// As wide as the numbers beside it: else copies of records are split in the middle of a word.
#[repr(u32)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Observation {
    /// v²/2 of the wheel speed: h x = e.
    Energy,
    /// GNSS altitude: h x = z + g.
    Altitude,
    /// The scale as it was before a stop: h x = κ.
    Scale,
    /// The slope of the road, from a sensor that measures it directly: h x = s − b − w + κ times net
    /// traction.
    RoadSlope,
    /// The slope that the vehicle model reads, from a sensor whose offset is relative to it: h x = s.
    ModelSlope,
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
    #[inline(never)] // As StateVector::dot().
    pub(crate) fn transpose_vector(
        &self,
        observation: Observation,
        net_traction: S,
        vector: &mut StateVector<S>,
    ) {
        observation.add_to(vector, net_traction, -self.gain.dot(vector));
    }

    /// Returns the normalised squared innovation ν²/S.
    #[inline]
    #[must_use]
    pub fn normalised_squared(&self) -> S {
        self.innovation.squared() / self.innovation_variance
    }
}

impl Observation {
    /// Returns h of a measurement that is rare: of all but energy and altitude, which have their own
    /// code wherever h is used.
    #[inline(never)] // Rare, and used in a dozen places.
    fn row<S: Scalar>(self, net_traction: S) -> StateVector<S> {
        let mut row = StateVector::ZERO;
        match self {
            Self::Energy | Self::Altitude => {}
            Self::Scale => row[Scale] = S::ONE,
            Self::ModelSlope => row[Slope] = S::ONE,
            Self::RoadSlope => {
                row[Slope] = S::ONE;
                row[Bias] = -S::ONE;
                row[Wind] = -S::ONE;
                row[Scale] = net_traction;
            }
        }
        row
    }

    /// Returns h x, where the net traction is this, %.
    #[inline(always)]
    #[must_use]
    pub fn of<S: Scalar>(self, x: &StateVector<S>, net_traction: S) -> S {
        match self {
            Self::Energy => x[KineticEnergy],
            Self::Altitude => x[Altitude] + x[GnssError],
            rare => rare.of_rare(x, net_traction),
        }
    }

    #[inline(never)] // Rare.
    fn of_rare<S: Scalar>(self, x: &StateVector<S>, net_traction: S) -> S {
        self.row(net_traction).dot(x)
    }

    /// Applies `v += factor * h'`.
    #[inline(always)]
    pub(crate) fn add_to<S: Scalar>(self, vector: &mut StateVector<S>, net_traction: S, factor: S) {
        match self {
            Self::Energy => vector[KineticEnergy] += factor,
            Self::Altitude => {
                vector[Altitude] += factor;
                vector[GnssError] += factor;
            }
            rare => rare.add_rare(vector, net_traction, factor),
        }
    }

    #[inline(never)] // Rare.
    fn add_rare<S: Scalar>(self, vector: &mut StateVector<S>, net_traction: S, factor: S) {
        let row = self.row(net_traction);
        for (element, h) in vector.0.iter_mut().zip(&row.0) {
            *element += factor * *h;
        }
    }

    /// Returns P h'.
    #[inline(always)]
    pub(super) fn cross<S: Scalar>(self, p: &Covariance<S>, net_traction: S) -> StateVector<S> {
        match self {
            Self::Energy => p.row(KineticEnergy),
            Self::Altitude => {
                let mut sum = p.row(Altitude);
                for (k, element) in sum.0.iter_mut().enumerate() {
                    *element += p.element(GnssError as usize, k);
                }
                sum
            }
            rare => p.times(&rare.row(net_traction)),
        }
    }

    /// Applies `M += f h' h - h' b - b' h`. Only what the measurement observes changes.
    #[inline(always)]
    pub(crate) fn add_products<S: Scalar>(
        self,
        matrix: &mut Covariance<S>,
        net_traction: S,
        b: &StateVector<S>,
        factor: S,
    ) {
        match self {
            Self::Energy => matrix.add_observation_products([KineticEnergy], b, factor),
            Self::Altitude => matrix.add_observation_products([Altitude, GnssError], b, factor),
            rare => matrix.add_row_products(&rare.row(net_traction), b, factor),
        }
    }
}

impl<S: Scalar> State<S> {
    /// Returns mean and variance of what a measurement observes.
    pub(super) fn observed(&self, observation: Observation) -> (f32, f32) {
        let cross = observation.cross(&self.covariance, self.net_traction);
        let mean = observation.of(&self.mean, self.net_traction);
        let variance = observation.of(&cross, self.net_traction);
        (mean.to_f32(), variance.to_f32())
    }
}

impl<S: Scalar> ScalarMeasurement<S> {
    /// Updates the state with the measurement.
    #[inline]
    pub fn apply(&self, state: &mut State<S>) -> ScalarUpdate<S> {
        let net_traction = state.net_traction;
        let cross = self.observation.cross(&state.covariance, net_traction);
        let innovation_variance = self.observation.of(&cross, net_traction) + self.variance;
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
