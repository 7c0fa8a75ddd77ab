//! How far estimates of one place share their errors, and how sure their mean is then.
//!
//! The model: of an estimate's error a part `c` is the same in all estimates, the rest is its
//! own. With weights w = 1/variance, W = Σw and Q = Σw², the weighted mean has the variance
//!
//! ```text
//! c + (1/W)(1 - c Q/W)  =  (1 - ρ + ρ n) / W        n = W²/Q        c = ρ W/Q
//! ```
//!
//! where n is Kish's effective number of estimates (L. Kish, Survey Sampling, 1965) and c is the
//! share ρ of the variance of those that carry the weight. For N equal estimates of variance v
//! that is v (ρ + (1 - ρ)/N). Squares about the mean then add up to (N - 1) - ρ (n - 1): runs
//! that err alike disagree less than their variances promise, and that tells ρ.
//!
//! Disagreement cannot tell a shared error from variances stated too large. It is read as shared,
//! which errs on the safe side, up to a share that is still usual; disagreement beyond what the
//! least usual share allows is read as variances stated too small.

use crate::map::geometry::grid::GRID_M;

/// Distance over which errors of a run are one and the same, m: neighbouring cells tell nothing
/// new. Differences of two simulated runs of one truck keep three quarters of their correlation
/// over 200 m and half of it over 1 km (the slow error of GNSS altitude, tens of seconds to
/// minutes).
const ERROR_LENGTH_M: f64 = 1000.0;

/// What is expected of estimates of one kind before they are compared.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Expectation {
    /// Share of the variance that is common where nothing else is known, and at least.
    usual: f64,
    /// At most.
    most: f64,
    /// Degrees of freedom that the usual share is worth.
    freedom: f64,
}

/// Runs of one vehicle in one session: parameters, load, tyres and the day's weather are the
/// same. The thesis's tables 5 to 8 give 0.11 to 0.29 for three runs of one truck, simulated
/// trucks with wrong parameters a third.
pub const WITHIN_SESSION: Expectation = Expectation {
    usual: 0.20,
    most: 0.40,
    freedom: 10.0,
};

/// Different vehicles or days: the road model flattens the same crests in all, and vehicles of
/// one make drive alike. Simulated, two trucks of one make have a sixth in common, of different
/// mass a twentieth. A quarter also covers runs of one session that nobody declared as such.
pub const BETWEEN_SESSIONS: Expectation = Expectation {
    usual: 0.10,
    most: 0.25,
    freedom: 10.0,
};

/// How far estimates differ, summed over cells. Sums of two places add.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Disagreement {
    /// Weighted squares about the mean.
    pub chi_squared: f64,
    /// What they would come to if estimates were independent: Σ (N - 1).
    pub freedom: f64,
    /// How much less for each unit of shared variance: Σ (n - 1).
    pub shared_freedom: f64,
}

impl Disagreement {
    /// Squared disagreement over what independent errors promise; `None` where no two estimates
    /// meet.
    pub fn ratio(&self) -> Option<f64> {
        (self.freedom > 0.0).then(|| self.chi_squared / self.freedom)
    }

    /// Adds that of other cells.
    pub fn add(&mut self, other: &Self) {
        self.chi_squared += other.chi_squared;
        self.freedom += other.freedom;
        self.shared_freedom += other.shared_freedom;
    }
}

/// How estimates of one kind depend on each other.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dependence {
    /// Part of the variance that is common to all.
    pub share: f64,
    /// True over stated variance; at least 1.
    pub inflation: f64,
}

impl Expectation {
    /// What the disagreement says, drawn towards what is usual while there is little of it.
    pub fn learn(&self, seen: &Disagreement) -> Dependence {
        // Cells within one error length are one observation.
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
