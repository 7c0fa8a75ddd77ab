//! What is known of one cell of a road, as sums.

use super::dependence::{Dependence, Disagreement};

/// A variance of the grade is taken within these, %²: sigmas of 0.00001 % (the last decimal of a
/// RUN.csv) to 1000 %, so that no square leaves the range of numbers.
const VARIANCE_LIMITS: (f64, f64) = (1e-10, 1e6);

/// Sums over the estimates of one cell: their order does not matter, and they stay as large as
/// they are however many estimates come. The default knows nothing. With w = 1/sigma².
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct CellSums {
    /// Number of estimates.
    pub estimates: u32,
    /// Sum of w of the grade, 1/%².
    pub weight: f64,
    /// Sum of w², 1/%⁴: tells how evenly the weight is spread.
    pub weight_square: f64,
    /// Sum of w times grade, 1/%.
    pub grade: f64,
    /// Sum of w times grade²: tells how far estimates disagree.
    pub grade_square: f64,
    /// Sum of 1/sigma² of the altitude, 1/m².
    pub altitude_weight: f64,
    /// Sum of altitude over sigma², 1/m.
    pub altitude: f64,
}

impl CellSums {
    /// Of one estimate: grade and its variance, %, and altitude and its variance, m.
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

    /// Adds what others know of the same place. Commutative.
    pub fn merge(&mut self, other: &Self) {
        self.estimates = self.estimates.saturating_add(other.estimates);
        self.weight += other.weight;
        self.weight_square += other.weight_square;
        self.grade += other.grade;
        self.grade_square += other.grade_square;
        self.altitude_weight += other.altitude_weight;
        self.altitude += other.altitude;
    }

    /// Weighted mean of the grade and its variance, %; `None` if nothing is known.
    pub fn grade(&self, dependence: &Dependence) -> Option<(f64, f64)> {
        let Dependence { share, inflation } = *dependence;
        (self.estimates > 0).then(|| {
            let spread = 1.0 - share + share * self.effective_estimates();
            (self.grade / self.weight, inflation * spread / self.weight)
        })
    }

    /// Weighted mean, m; `None` if nothing is known.
    pub fn altitude_m(&self) -> Option<f64> {
        (self.altitude_weight > 0.0).then(|| self.altitude / self.altitude_weight)
    }

    /// All estimates as one: their mean, with the variance that their dependence leaves it.
    pub fn pooled(&self, dependence: &Dependence) -> Self {
        self.grade(dependence)
            .map_or_else(Self::default, |grade| Self {
                altitude_weight: self.altitude_weight,
                altitude: self.altitude,
                ..Self::of(grade, None)
            })
    }

    /// How far the estimates differ here.
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

    /// Kish's effective number, between 1 and the number of estimates.
    fn effective_estimates(&self) -> f64 {
        self.weight * self.weight / self.weight_square
    }
}
