//! Estimates beside the judge, over windows.

use crate::inertial_judge::Window;
use crate::numeric::statistics::mean;

/// Differences between what is judged and the judge, over the windows of a trip.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Differences {
    /// Mean difference, %: the offset of the judge is in it.
    pub(super) offset_percent: f64,
    /// Root mean square without the offset, %.
    pub(super) rms_percent: f64,
    /// Mean squared difference without the offset over the variances of both.
    pub(super) nees: f64,
    /// Number of windows.
    pub(super) windows: usize,
}

/// Least number of windows from which an offset can be removed.
const FEWEST_WINDOWS: usize = 5;

/// Compares grades with their sigmas, %, over these windows; `None` if there are too few.
pub(super) fn differences(
    windows: &[Window],
    grade: impl Fn(&Window) -> Option<(f64, f64)>,
) -> Option<Differences> {
    let pairs: Vec<(f64, f64)> = windows
        .iter()
        .filter_map(|window| {
            let (grade_percent, sigma_percent) = grade(window)?;
            let variance = sigma_percent.powi(2) + window.sigma_percent.powi(2);
            Some((grade_percent - window.grade_percent, variance))
        })
        .collect();
    if pairs.len() < FEWEST_WINDOWS {
        return None;
    }
    let mean_of = |of: &dyn Fn(&(f64, f64)) -> f64| mean(&pairs.iter().map(of).collect::<Vec<_>>());
    let offset_percent = mean_of(&|pair| pair.0);
    let square = |pair: &(f64, f64)| (pair.0 - offset_percent).powi(2);
    Some(Differences {
        offset_percent,
        rms_percent: mean_of(&square).sqrt(),
        nees: mean_of(&|pair| square(pair) / pair.1),
        windows: pairs.len(),
    })
}
