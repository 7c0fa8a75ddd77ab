//! The scalar update of the filter.

use super::applied::{Fate, Update};
use crate::filter::covariance::StateVector;
use crate::filter::state::State;
use crate::filter::state_index::STATES;
use crate::scalar::Scalar;

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
