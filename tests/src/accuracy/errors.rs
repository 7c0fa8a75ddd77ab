//! Errors of the three estimates.

use super::estimate::Estimate;
use host_sim::numeric::statistics::mean;

/// The error of a cell or a window.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GradeError {
    /// Estimate less truth, %.
    pub error_percent: f64,
    /// The variance that the estimate states, with that of the judge, %².
    pub variance: f64,
}

/// Errors of the estimates, in the order of [`Estimate::ALL`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Errors {
    /// Root mean square, %.
    pub rmse_percent: [f64; 3],
    /// Mean of squared errors over their variances.
    pub nees: [f64; 3],
}

impl Errors {
    /// Sums up the errors that `of` returns for each estimate; NaN where there are none.
    pub fn new(of: impl Fn(Estimate) -> Vec<GradeError>) -> Self {
        let errors = Estimate::ALL.map(of);
        let mean_of = |errors: &[GradeError], square: fn(&GradeError) -> f64| {
            mean(&errors.iter().map(square).collect::<Vec<_>>())
        };
        Self {
            rmse_percent: errors
                .each_ref()
                .map(|of| mean_of(of, |of| of.error_percent.powi(2)).sqrt()),
            nees: errors
                .each_ref()
                .map(|of| mean_of(of, |of| of.error_percent.powi(2) / of.variance)),
        }
    }
}
