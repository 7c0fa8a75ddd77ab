//! The scalar update of the filter.

use crate::filter::covariance::StateVector;
use crate::filter::state::State;
use crate::filter::state_index::STATES;
use crate::scalar::Scalar;

/// A scalar update.
#[derive(Clone, Copy, Debug)]
pub struct Update<S> {
    /// Innovation ν.
    pub innovation: S,
    /// Innovation variance h P h' + R.
    pub innovation_variance: S,
    /// Gain P h' over the innovation variance; zero if the measurement was left out.
    pub gain: StateVector<S>,
    fate: Fate,
}

/// What became of a measurement. No value is zero, so that `None` of an update is: an empty record then
/// takes no flash.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Fate {
    Used = 1,
    /// Beyond the gate.
    LeftOut = 2,
}

impl<S: Scalar> Update<S> {
    /// Returns it if the measurement was used.
    #[inline(always)]
    pub fn used(&self) -> Option<&Self> {
        (self.fate == Fate::Used).then_some(self)
    }
}

impl<S: Scalar> State<S> {
    /// Updates with a measurement whose covariance with the states is `cross`. It is left out if its
    /// squared innovation exceeds `gate` times its variance.
    #[inline(never)] // One copy: flash is small.
    pub(super) fn update(
        &mut self,
        innovation: S,
        innovation_variance: S,
        cross: &StateVector<S>,
        gate: Option<S>,
    ) -> Update<S> {
        let mut update = Update {
            innovation,
            innovation_variance,
            gain: [S::ZERO; STATES],
            fate: Fate::LeftOut,
        };
        if gate.is_some_and(|gate| innovation.squared() > gate * innovation_variance) {
            return update;
        }
        update.fate = Fate::Used;
        let per_variance = S::ONE / innovation_variance;
        update.gain = cross.map(|element| element * per_variance);
        for (x, gain) in self.mean.iter_mut().zip(&update.gain) {
            x.add_product(innovation, gain);
        }
        self.covariance.reduce(&update.gain, cross);
        update
    }
}
