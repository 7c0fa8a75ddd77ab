//! Curves fitted to the RMSE as a function of the number of runs.

/// RMSE = first · N^-exponent.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PowerLaw {
    /// RMSE of one run, %.
    pub first_percent: f64,
    /// Exponent, c in the thesis.
    pub exponent: f64,
}

impl PowerLaw {
    /// Fits a line by least squares to the logarithms of the RMSE (%) after 1, 2, 3, ... runs.
    #[must_use]
    pub fn fit(rmse_percent: &[f64]) -> Self {
        let points: Vec<(f64, f64)> = (1..)
            .zip(rmse_percent)
            .map(|(n, rmse)| (f64::from(n).ln(), rmse.ln()))
            .collect();
        let (offset, slope) = line(&points);
        Self {
            first_percent: offset.exp(),
            exponent: -slope,
        }
    }

    /// Returns the RMSE of `n` runs, %.
    #[must_use]
    pub fn at(&self, n: usize) -> f64 {
        self.first_percent * (n as f64).powf(-self.exponent)
    }
}

/// Returns the floor of the RMSE for an unlimited number of runs, fitted to the RMSE (%) after
/// 1, 2, 3, ... runs, without the first `skipped`. Independent errors average out; errors that all
/// runs share form the floor.
#[must_use]
pub fn floor_percent(rmse_percent: &[f64], skipped: usize) -> f64 {
    let points: Vec<(f64, f64)> = (1..)
        .zip(rmse_percent)
        .skip(skipped)
        .map(|(n, rmse)| (f64::from(n), rmse * rmse))
        .collect();
    floor_and_slope(&points).0.max(0.0).sqrt()
}

/// Returns `a` and `b` of `a + b / n`, fitted by least squares to mean squares of maps of so many
/// runs.
#[must_use]
pub fn floor_and_slope(mean_squares: &[(f64, f64)]) -> (f64, f64) {
    let points: Vec<(f64, f64)> = mean_squares
        .iter()
        .map(|(n, square)| (1.0 / n, *square))
        .collect();
    line(&points)
}

/// Returns the offset and the slope of the least-squares line.
fn line(points: &[(f64, f64)]) -> (f64, f64) {
    let n = points.len() as f64;
    let (x, y) = points
        .iter()
        .fold((0.0, 0.0), |sum, p| (sum.0 + p.0, sum.1 + p.1));
    let (x, y) = (x / n, y / n);
    let (xy, xx) = points.iter().fold((0.0, 0.0), |sum, p| {
        (sum.0 + (p.0 - x) * (p.1 - y), sum.1 + (p.0 - x).powi(2))
    });
    let slope = xy / xx;
    (y - slope * x, slope)
}
