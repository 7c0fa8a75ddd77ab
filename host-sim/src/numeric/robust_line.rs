//! A straight line through points with outliers: iteratively reweighted least squares with
//! Tukey's bisquare (P. J. Huber, E. M. Ronchetti, "Robust Statistics", ch. 7; the tuning
//! constant 4.685 gives 95 % efficiency on normal errors).

/// y = slope · x + offset.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RobustLine {
    /// dy/dx.
    pub slope: f64,
    /// Standard error of the slope.
    pub slope_sigma: f64,
    /// y at x = 0.
    pub offset: f64,
}

impl RobustLine {
    /// Returns y at `x`.
    #[must_use]
    pub fn at(&self, x: f64) -> f64 {
        self.slope * x + self.offset
    }
}

const TUNING: f64 = 4.685;
/// Median absolute deviation of normal errors, in standard deviations.
const MAD_OF_NORMAL: f64 = 0.6745;
const ITERATIONS: usize = 50;
/// Smallest number of points. With fewer, outliers cannot be detected.
const FEWEST_POINTS: usize = 4;

/// Fits a line; `None` with too few points, or if all have the same x.
#[must_use]
pub fn fit(points: impl IntoIterator<Item = (f64, f64)>) -> Option<RobustLine> {
    let points: Vec<(f64, f64)> = points.into_iter().collect();
    if points.len() < FEWEST_POINTS {
        return None;
    }
    let mut weights = vec![1.0; points.len()];
    let mut line = weighted(&points, &weights)?;
    for _ in 0..ITERATIONS {
        let scale = residual_scale(&points, &line);
        if scale <= 0.0 {
            break;
        }
        for (weight, (x, y)) in weights.iter_mut().zip(&points) {
            let u = (y - line.at(*x)) / (TUNING * scale);
            *weight = if u.abs() < 1.0 {
                (1.0 - u * u).powi(2)
            } else {
                0.0
            };
        }
        let next = weighted(&points, &weights)?;
        let change = (next.slope - line.slope).abs();
        line = next;
        if change <= 1e-12 * (1.0 + line.slope.abs()) {
            break;
        }
    }
    Some(line)
}

fn weighted(points: &[(f64, f64)], weights: &[f64]) -> Option<RobustLine> {
    let sum = |f: &dyn Fn(f64, f64) -> f64| -> f64 {
        points
            .iter()
            .zip(weights)
            .map(|((x, y), w)| w * f(*x, *y))
            .sum()
    };
    let total = sum(&|_, _| 1.0);
    let (mean_x, mean_y) = (sum(&|x, _| x) / total, sum(&|_, y| y) / total);
    let spread = sum(&|x, _| (x - mean_x).powi(2));
    let slope = sum(&|x, y| (x - mean_x) * (y - mean_y)) / spread;
    let offset = mean_y - slope * mean_x;
    let error = sum(&|x, y| (y - slope * x - offset).powi(2));
    let slope_sigma = (error / (total - 2.0) / spread).sqrt();
    (slope.is_finite() && total > 2.0).then_some(RobustLine {
        slope,
        slope_sigma,
        offset,
    })
}

fn residual_scale(points: &[(f64, f64)], line: &RobustLine) -> f64 {
    let mut residuals: Vec<f64> = points
        .iter()
        .map(|(x, y)| (y - line.at(*x)).abs())
        .collect();
    residuals.sort_by(f64::total_cmp);
    residuals[residuals.len() / 2] / MAD_OF_NORMAL
}
