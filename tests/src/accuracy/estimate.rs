//! The three estimates of a cell.

use host_sim::files::run::RunRow;

/// An estimate of the grade.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Estimate {
    /// Of the whole run.
    Smoothed,
    /// After a fixed lag.
    Lagged,
    /// Causal.
    Live,
}

impl Estimate {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::Smoothed, Self::Lagged, Self::Live];

    /// Returns its name.
    #[must_use]
    pub const fn word(self) -> &'static str {
        match self {
            Self::Smoothed => "smoothed",
            Self::Lagged => "lagged",
            Self::Live => "live",
        }
    }

    /// Returns grade and sigma of a cell, %.
    #[must_use]
    pub const fn of(self, row: &RunRow) -> (f64, f64) {
        match self {
            Self::Smoothed => (row.grade_percent, row.grade_sigma_percent),
            Self::Lagged => (row.lagged_grade_percent, row.lagged_grade_sigma_percent),
            Self::Live => (row.live_grade_percent, row.live_grade_sigma_percent),
        }
    }
}
