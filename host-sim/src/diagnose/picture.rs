//! Plots of the unexplained residual over the variable that it depends on.

use super::dependence::Variable;
use super::drive::{CommonRoad, LoggedDrive};
use super::judgement::{self, ReferenceGrades};
use crate::report::page::Figure;
use crate::report::plot::{Plot, Series, colour};
use estimator_core::Model;

/// Number of parts of the variable's range.
const PARTS: usize = 24;
/// Fewest cells for a mean.
const FEWEST_CELLS: usize = 20;

/// Returns a plot of the mean error of the bare model over a variable, with all adopted effects.
#[must_use]
pub fn picture(
    name: &str,
    variable: Variable,
    drives: &[LoggedDrive],
    model: &Model,
    references: &[ReferenceGrades],
    road: Option<&CommonRoad>,
) -> Figure {
    let mut points: Vec<(f64, f64)> = Vec::new();
    for (drive, reference) in drives.iter().zip(references) {
        let places = road.map(|road| road.places(drive));
        let values = variable.values(drive, places.as_deref());
        let errors = judgement::errors(drive, model, reference);
        points.extend(
            values
                .iter()
                .zip(errors)
                .filter_map(|(v, e)| Some(((*v)?, e?))),
        );
    }
    points.sort_by(|a, b| a.0.total_cmp(&b.0));
    // Parts have equal numbers of cells; for places and clocks they have equal lengths.
    let even = matches!(variable, Variable::Road(_) | Variable::Phase(_));
    let (low, high) = match (points.first(), points.last()) {
        (Some(first), Some(last)) => (first.0, last.0),
        _ => (0.0, 1.0),
    };
    let part_of = |index: usize, value: f64| {
        let part = if even {
            ((value - low) / (high - low).max(1e-9) * PARTS as f64) as usize
        } else {
            index * PARTS / points.len()
        };
        part.min(PARTS - 1)
    };
    let mut sums = [(0.0, 0.0, 0_usize); PARTS];
    for (index, &(value, error)) in points.iter().enumerate() {
        let sum = &mut sums[part_of(index, value)];
        sum.0 += value;
        sum.1 += error;
        sum.2 += 1;
    }
    let means = sums
        .iter()
        .filter(|sum| sum.2 >= FEWEST_CELLS)
        .map(|sum| (sum.0 / sum.2 as f64, sum.1 / sum.2 as f64));
    let plot = Plot::new(variable.label(), "model less reference (% grade)").with(Series::line(
        "mean of all drives",
        colour::CYCLE[0],
        means,
    ));
    Figure::new(
        name,
        &plot,
        "What is left of the bare model's error with all that was adopted.",
    )
}
