//! Means of grades over windows of time.

use crate::files::run::RunRow;
use crate::numeric::series::linear;
use crate::numeric::slope::grade;

/// The grades of a run and their sigmas as sums over its cells, by time.
#[derive(Clone, Debug)]
pub(super) struct RunSums {
    cells: Vec<(f64, f64)>,
    grades: Vec<(f64, f64)>,
    sigmas: Vec<(f64, f64)>,
}

impl RunSums {
    /// Sums the grade and sigma, %, that `of` returns for each cell.
    pub(super) fn new(rows: &[RunRow], of: fn(&RunRow) -> (f64, f64)) -> Self {
        let mut sums = Self {
            cells: Vec::with_capacity(rows.len()),
            grades: Vec::with_capacity(rows.len()),
            sigmas: Vec::with_capacity(rows.len()),
        };
        let (mut cells, mut grades, mut sigmas) = (0.0, 0.0, 0.0);
        for row in rows {
            let (grade_percent, sigma_percent) = of(row);
            cells += 1.0;
            grades += grade_percent;
            sigmas += sigma_percent;
            sums.cells.push((row.time_s, cells));
            sums.grades.push((row.time_s, grades));
            sums.sigmas.push((row.time_s, sigmas));
        }
        sums
    }

    /// Returns mean grade and mean sigma, %, from one time to another, s: the errors within a
    /// window are taken as common. `None` outside the run.
    pub(super) fn mean(&self, from_s: f64, to_s: f64) -> Option<(f64, f64)> {
        let change = |of: &[(f64, f64)]| Some(linear(of, to_s)? - linear(of, from_s)?);
        let cells = change(&self.cells)?;
        let is_driven = cells >= 1.0;
        is_driven.then_some((change(&self.grades)? / cells, change(&self.sigmas)? / cells))
    }
}

/// Returns the grade, %, that a climb over time gives on a way of `length_m`; `None` outside. A
/// model's climb is the sine of the slope times the way.
pub(super) fn grade_of_climb(
    climbs: &[(f64, f64)],
    (from_s, to_s): (f64, f64),
    length_m: f64,
) -> Option<f64> {
    let climb_m = linear(climbs, to_s)? - linear(climbs, from_s)?;
    let sine = (climb_m / length_m).clamp(-0.9, 0.9);
    Some(100.0 * grade(sine))
}
