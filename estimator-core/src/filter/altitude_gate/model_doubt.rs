//! Doubt of the vehicle model, before anything is certain.
//!
//! A resistance that comes at once (snow, a headwind, a power take-off) makes forces and altitudes
//! climb unlike each other. The climb test is certain of that after kilometres. Until then most of its
//! comparisons exceed their variances, one after the other, with the same sign. The excess is added to
//! the variance of the live and the lagged grade. The states do not change: on hilly roads such a row
//! of comparisons often ends by itself, and a filter that followed each row would have larger errors.

use super::climb_test::ClimbTestResult;
use crate::scalar::Scalar;
use crate::tuning::Gates;

/// Comparisons in a row that say the same, and what the last one shows.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct ModelDoubt {
    comparisons: u8,
    /// Whether altitudes climb more than the forces.
    is_above: bool,
    variance: f32,
}

impl ModelDoubt {
    /// Returns the variance of the grade beyond what the states say, %².
    pub(super) const fn variance(&self) -> f32 {
        self.variance
    }

    /// Takes a comparison. `ratio` is the learned over the assumed variance of comparisons.
    pub(super) fn compare(&mut self, result: &ClimbTestResult, ratio: f32, gates: &Gates) {
        let seen = &result.seen;
        let most = gates.doubt_mean * ratio;
        if seen.mean <= most {
            *self = Self::default();
            return;
        }
        let is_above = seen.slope_percent > 0.0;
        if is_above != self.is_above {
            self.comparisons = 0;
        }
        self.is_above = is_above;
        self.comparisons = self.comparisons.saturating_add(1);
        self.variance = if self.comparisons < gates.doubt_fixes {
            0.0
        } else {
            let known_part = Scalar::sqrt(most / Scalar::max(seen.largest, most));
            let beyond_percent = (1.0 - known_part) * seen.slope_percent.abs();
            let doubt_percent = Scalar::min(beyond_percent, gates.slope_step_percent);
            doubt_percent * doubt_percent
        };
    }
}
