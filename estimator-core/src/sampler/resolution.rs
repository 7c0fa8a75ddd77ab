//! The resolution of a sensor.

use crate::scalar::Scalar;

/// The smallest change of a sensor's readings so far.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Resolution(Option<f32>);

impl Resolution {
    /// Notes the change from one reading to the next.
    pub(super) fn note(&mut self, change: f32) {
        let step = change.abs();
        self.0 = Some(self.0.map_or(step, |least| Scalar::min(least, step)));
    }

    /// Returns the smallest change; `None` before the first.
    pub(super) const fn step(self) -> Option<f32> {
        self.0
    }

    /// Returns the smallest change; 0 before the first, and where it is larger than the steps of any
    /// sensor.
    pub(super) fn within(self, coarsest: f32) -> f32 {
        self.0.filter(|step| *step <= coarsest).unwrap_or(0.0)
    }
}
