//! The sums of one cell of a road.

use super::dependence::{Dependence, Disagreement};

/// Limits of the grade variance, %²: sigmas of 0.00001 % (the last decimal of a RUN.csv) to 1000 %,
/// so that no square overflows.
const VARIANCE_LIMITS: (f64, f64) = (1e-10, 1e6);

/// Sums over the estimates of one cell, with w = 1/sigma². They do not depend on the order of the
/// estimates, and their size does not grow. The default has no estimate.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct CellSums {
    /// Number of estimates.
    pub estimates: u32,
    /// Sum of w of the grade, 1/%².
    pub weight: f64,
    /// Sum of w², 1/%⁴, for the effective number of estimates.
    pub weight_square: f64,
    /// Sum of w times grade, 1/%.
    pub grade: f64,
    /// Sum of w times grade², for the disagreement.
    pub grade_square: f64,
    /// Sum of 1/sigma² of the altitude, 1/m².
    pub altitude_weight: f64,
    /// Sum of altitude over sigma², 1/m.
    pub altitude: f64,
}

impl CellSums {
    /// Creates the sums of one estimate: grade and its variance, %, and altitude and its variance,
    /// m.
    pub fn of(grade: (f64, f64), altitude: Option<(f64, f64)>) -> Self {
        let (grade_percent, variance) = grade;
        let weight = variance.clamp(VARIANCE_LIMITS.0, VARIANCE_LIMITS.1).recip();
        let (altitude_m, altitude_weight) = altitude
            .map_or((0.0, 0.0), |(altitude_m, variance)| {
                (altitude_m, 1.0 / variance)
            });
        Self {
            estimates: 1,
            weight,
            weight_square: weight * weight,
            grade: weight * grade_percent,
            grade_square: weight * grade_percent * grade_percent,
            altitude_weight,
            altitude: altitude_weight * altitude_m,
        }
    }

    /// Adds the sums of other estimates of the same cell. Commutative.
    pub fn merge(&mut self, other: &Self) {
        self.estimates = self.estimates.saturating_add(other.estimates);
        self.weight += other.weight;
        self.weight_square += other.weight_square;
        self.grade += other.grade;
        self.grade_square += other.grade_square;
        self.altitude_weight += other.altitude_weight;
        self.altitude += other.altitude;
    }

    /// Returns the weighted mean of the grade and its variance, %; `None` without estimates.
    pub fn grade(&self, dependence: &Dependence) -> Option<(f64, f64)> {
        let Dependence { share, inflation } = *dependence;
        (self.estimates > 0).then(|| {
            let spread = 1.0 - share + share * self.effective_estimates();
            (self.grade / self.weight, inflation * spread / self.weight)
        })
    }

    /// Returns the weighted mean of the altitude, m; `None` without estimates.
    pub fn altitude_m(&self) -> Option<f64> {
        (self.altitude_weight > 0.0).then(|| self.altitude / self.altitude_weight)
    }

    /// Combines all estimates into one: their mean, with the variance under this correlation.
    pub fn pooled(&self, dependence: &Dependence) -> Self {
        self.grade(dependence)
            .map_or_else(Self::default, |grade| Self {
                altitude_weight: self.altitude_weight,
                altitude: self.altitude,
                ..Self::of(grade, None)
            })
    }

    /// Returns the disagreement of the estimates.
    pub fn disagreement(&self) -> Disagreement {
        if self.estimates < 2 {
            return Disagreement::default();
        }
        let squares = self.grade_square - self.grade * self.grade / self.weight;
        Disagreement {
            // Rounding must not make a sum of squares negative.
            chi_squared: squares.max(0.0),
            freedom: f64::from(self.estimates - 1),
            shared_freedom: self.effective_estimates() - 1.0,
        }
    }

    /// Returns Kish's effective number of estimates, between 1 and their number.
    fn effective_estimates(&self) -> f64 {
        self.weight * self.weight / self.weight_square
    }
}
