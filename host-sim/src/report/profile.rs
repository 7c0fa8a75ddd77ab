//! Profiles: values along a road with their standard deviations.

use super::plot::{Plot, Series};
use plotters::style::RGBColor;

/// A step longer than this many times the usual one is a gap.
const GAP_STEPS: f64 = 1.5;

/// A value at a place of a road.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ProfilePoint {
    /// Distance along the road, m.
    pub distance_m: f64,
    /// Value, in the unit of the plot's y axis.
    pub value: f64,
    /// Its standard deviation, in the same unit, if it is known.
    pub sigma: Option<f64>,
}

impl Plot {
    /// Creates an empty profile: distance in km from left to right. Figures of a page with the
    /// same `link` share hover and zoom; give a plan's line the same one.
    #[must_use]
    pub fn profile(y_label: impl Into<String>, link: impl Into<String>) -> Self {
        Self::new("distance (km)", y_label).linked(link)
    }

    /// Returns the profile with one more curve, in front of a band of two sigmas if any point has a
    /// sigma. The curve has a gap where the road has one, e.g. cells without a run.
    #[must_use]
    pub fn with_profile(
        self,
        name: impl Into<String>,
        colour: RGBColor,
        points: impl IntoIterator<Item = ProfilePoint>,
    ) -> Self {
        let name = name.into();
        let points = with_gaps(points.into_iter().collect());
        let plot = if points.iter().any(|point| point.sigma.is_some()) {
            let band = points.iter().map(|point| {
                let sigma = point.sigma.unwrap_or(f64::NAN);
                (point.distance_m * 1e-3, point.value, sigma)
            });
            self.with(Series::two_sigma(
                format!("{name}, ± 2 sigma"),
                colour,
                band,
            ))
        } else {
            self
        };
        let line = points.iter().map(|of| (of.distance_m * 1e-3, of.value));
        plot.with(Series::line(name, colour, line))
    }
}

/// Returns the points with one without a value in each gap.
fn with_gaps(points: Vec<ProfilePoint>) -> Vec<ProfilePoint> {
    let mut steps: Vec<f64> = points
        .windows(2)
        .map(|pair| pair[1].distance_m - pair[0].distance_m)
        .collect();
    steps.sort_by(f64::total_cmp);
    let longest = GAP_STEPS * steps.get(steps.len() / 2).copied().unwrap_or(f64::INFINITY);
    let mut all: Vec<ProfilePoint> = Vec::with_capacity(points.len());
    for point in points {
        let before = all.last().map(|before| before.distance_m);
        if let Some(before_m) = before.filter(|before_m| point.distance_m - before_m > longest) {
            all.push(ProfilePoint {
                distance_m: 0.5 * (before_m + point.distance_m),
                value: f64::NAN,
                sigma: None,
            });
        }
        all.push(point);
    }
    all
}
