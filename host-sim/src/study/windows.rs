//! Grade errors over long windows.
//!
//! A reference from GNSS altitudes is noisy in short windows. The mean grade of a window is the
//! altitude change over its length, so the noise falls with the length.

use crate::numeric::series::linear;

/// Grade over the distance along one road, with linear interpolation.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct GradeProfile {
    /// Distance in m, strictly increasing, and grade in %.
    points: Vec<(f64, f64)>,
}

/// Errors of mean grades over windows, in % grade.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct WindowErrors {
    /// Root of the mean squared error.
    pub rmse_percent: f64,
    /// Mean error, positive where the estimate is too high.
    pub bias_percent: f64,
    /// Number of windows.
    pub windows: usize,
}

/// Step of the common grid of two profiles, m: four cells.
const GRID_M: f64 = 10.0;

impl GradeProfile {
    /// Creates a profile from pairs of distance (m) and grade (%). Pairs that do not increase the
    /// distance or are not finite are left out.
    #[must_use]
    pub fn new(pairs: impl IntoIterator<Item = (f64, f64)>) -> Self {
        Self {
            points: forward(pairs),
        }
    }

    /// Creates a profile from pairs of distance (m) along the road and altitude (m). The grade at
    /// each is the altitude change over `base_m` around it; over less at the ends.
    #[must_use]
    pub fn from_altitudes(pairs: impl IntoIterator<Item = (f64, f64)>, base_m: f64) -> Self {
        let altitudes = forward(pairs);
        let grade_percent = |&(at_m, _): &(f64, f64)| {
            let (start_m, end_m) = (at_m - 0.5 * base_m, at_m + 0.5 * base_m);
            let (first, last) = (altitudes.first()?.0, altitudes.last()?.0);
            let (start_m, end_m) = (start_m.max(first), end_m.min(last));
            let run_m = end_m - start_m;
            let rise_m = linear(&altitudes, end_m)? - linear(&altitudes, start_m)?;
            (run_m > 0.0).then_some((at_m, 100.0 * rise_m / run_m))
        };
        Self {
            points: altitudes.iter().filter_map(grade_percent).collect(),
        }
    }

    /// Returns the grade (%) at a distance in m; `None` beyond the ends.
    #[must_use]
    pub fn grade_percent(&self, at_m: f64) -> Option<f64> {
        linear(&self.points, at_m)
    }

    fn ends_m(&self) -> Option<(f64, f64)> {
        Some((self.points.first()?.0, self.points.last()?.0))
    }
}

/// Returns the errors of `estimate` against `reference`, both as means over windows of `window_m`.
/// The windows follow one another over the part of the road that both cover. Returns `None` if that
/// part is shorter than one window.
#[must_use]
pub fn window_errors(
    estimate: &GradeProfile,
    reference: &GradeProfile,
    window_m: f64,
) -> Option<WindowErrors> {
    let (a, b) = (estimate.ends_m()?, reference.ends_m()?);
    let (start_m, end_m) = (a.0.max(b.0), a.1.min(b.1));
    let steps = (window_m / GRID_M).round().max(1.0) as usize;
    let mut errors = Vec::new();
    let mut from_m = start_m;
    while from_m + window_m <= end_m {
        let step_m = window_m / steps as f64;
        let sum = (0..steps)
            .map(|step| {
                let at_m = from_m + (step as f64 + 0.5) * step_m;
                Some(estimate.grade_percent(at_m)? - reference.grade_percent(at_m)?)
            })
            .sum::<Option<f64>>()?;
        errors.push(sum / steps as f64);
        from_m += window_m;
    }
    let count = errors.len() as f64;
    (!errors.is_empty()).then(|| WindowErrors {
        rmse_percent: (errors.iter().map(|e| e * e).sum::<f64>() / count).sqrt(),
        bias_percent: errors.iter().sum::<f64>() / count,
        windows: errors.len(),
    })
}

pub(crate) fn forward(pairs: impl IntoIterator<Item = (f64, f64)>) -> Vec<(f64, f64)> {
    let mut points: Vec<(f64, f64)> = Vec::new();
    for (at_m, value) in pairs {
        let goes_on = points.last().is_none_or(|last| at_m > last.0);
        if goes_on && at_m.is_finite() && value.is_finite() {
            points.push((at_m, value));
        }
    }
    points
}
