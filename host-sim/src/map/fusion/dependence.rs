//! Correlation of the errors of several estimates of one place, and the variance of their mean.
//!
//! Model: a part `c` of the error variance is common to all estimates, the rest is independent.
//! With weights w = 1/variance, W = Σw and Q = Σw², the weighted mean has the variance
//!
//! ```text
//! c + (1/W)(1 - c Q/W)  =  (1 - ρ + ρ n) / W        n = W²/Q        c = ρ W/Q
//! ```
//!
//! where n is Kish's effective number of estimates (L. Kish, Survey Sampling, 1965) and c is the
//! share ρ of the variance of those that carry the weight. For N equal estimates of variance v that
//! is v (ρ + (1 - ρ)/N). Squares about the mean then add up to (N - 1) - ρ (n - 1). Runs with
//! common errors disagree less than their variances allow, and ρ follows from that.
//!
//! Disagreement cannot separate a common error from variances that are too large. Low disagreement
//! counts as a common error, the safe choice, up to a usual share. High disagreement counts as
//! variances that are too small.

use crate::map::geometry::grid::GRID_M;

/// Distance over which the error of a run is constant, m; neighbouring cells are not independent.
/// Differences of two simulated runs of one truck keep three quarters of their correlation over 200
/// m and half of it over 1 km (the slow error of GNSS altitude, tens of seconds to minutes).
const ERROR_LENGTH_M: f64 = 1000.0;

/// Prior of the correlation of estimates of one kind.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Expectation {
    /// Common share of the variance without other information; also the minimum.
    usual: f64,
    /// Maximum common share.
    most: f64,
    /// Weight of the prior, degrees of freedom.
    freedom: f64,
}

/// Runs of one vehicle in one session have the same parameters, load, tyres and weather. The
/// thesis's tables 5 to 8 give 0.11 to 0.29 for three runs of one truck; simulated trucks with
/// wrong parameters give a third.
pub const WITHIN_SESSION: Expectation = Expectation {
    usual: 0.20,
    most: 0.40,
    freedom: 10.0,
};

/// Different vehicles or days: the road model flattens the same crests in all, and vehicles of one
/// make behave alike. In simulation two trucks of one make share a sixth, two of different mass a
/// twentieth. A quarter also covers runs of one session that are not declared as such.
pub const BETWEEN_SESSIONS: Expectation = Expectation {
    usual: 0.10,
    most: 0.25,
    freedom: 10.0,
};

/// Disagreement of estimates, summed over cells. Sums of two places can be added.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Disagreement {
    /// Weighted squares about the mean.
    pub chi_squared: f64,
    /// Their expectation for independent estimates: Σ (N - 1).
    pub freedom: f64,
    /// Reduction per unit of common share: Σ (n - 1).
    pub shared_freedom: f64,
}

impl Disagreement {
    /// Returns the squared disagreement over its expectation for independent errors; `None` if no
    /// two estimates meet.
    pub fn ratio(&self) -> Option<f64> {
        (self.freedom > 0.0).then(|| self.chi_squared / self.freedom)
    }

    /// Adds the disagreement of other cells.
    pub fn add(&mut self, other: &Self) {
        self.chi_squared += other.chi_squared;
        self.freedom += other.freedom;
        self.shared_freedom += other.shared_freedom;
    }
}

/// Correlation of estimates of one kind.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dependence {
    /// Common share of the variance.
    pub share: f64,
    /// True over stated variance; at least 1.
    pub inflation: f64,
}

impl Expectation {
    /// Estimates the correlation from the disagreement, regularized towards the prior.
    pub fn learn(&self, seen: &Disagreement) -> Dependence {
        // Cells within one correlation length are one observation.
        let scale = GRID_M / ERROR_LENGTH_M;
        let freedom = self.freedom + scale * seen.freedom;
        let shared_freedom = self.freedom + scale * seen.shared_freedom;
        let chi_squared = self.freedom * (1.0 - self.usual) + scale * seen.chi_squared;
        let share = ((freedom - chi_squared) / shared_freedom).clamp(self.usual, self.most);
        Dependence {
            share,
            inflation: (chi_squared / (freedom - share * shared_freedom)).max(1.0),
        }
    }
}
