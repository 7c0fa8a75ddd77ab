//! What a scalar update leaves.

use crate::filter::covariance::StateVector;
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
    pub(super) fate: Fate,
}

/// What became of a measurement. No value is zero, so that `None` of an update is: an empty record then
/// takes no flash.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Fate {
    /// It corrects the prediction.
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
