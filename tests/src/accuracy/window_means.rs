//! Means of cells over windows.

use host_sim::numeric::series::linear;

/// Sums over the cells of a run, by their place or time.
#[derive(Clone, Debug, Default)]
pub struct WindowMeans {
    cells: Vec<(f64, f64)>,
    grades: Vec<(f64, f64)>,
    sigmas: Vec<(f64, f64)>,
}

impl WindowMeans {
    /// Sums cells, in order: where or when each ends, its grade (or error) and sigma, %.
    pub fn new(cells: impl IntoIterator<Item = (f64, (f64, f64))>) -> Self {
        let mut sums = Self::default();
        let (mut count, mut grades, mut sigmas) = (0.0, 0.0, 0.0);
        for (at, (grade_percent, sigma_percent)) in cells {
            count += 1.0;
            grades += grade_percent;
            sigmas += sigma_percent;
            sums.cells.push((at, count));
            sums.grades.push((at, grades));
            sums.sigmas.push((at, sigmas));
        }
        sums
    }

    /// Returns mean grade and mean sigma of a window, %: the errors within it are taken as common.
    /// `None` outside the run, and with less than one cell.
    #[must_use]
    pub fn mean(&self, from: f64, to: f64) -> Option<(f64, f64)> {
        let change = |sums: &[(f64, f64)]| Some(linear(sums, to)? - linear(sums, from)?);
        let cells = change(&self.cells)?;
        let is_driven = cells >= 1.0;
        is_driven.then_some((change(&self.grades)? / cells, change(&self.sigmas)? / cells))
    }

    /// Returns the windows of a length that follow one another from `from` to the last cell.
    pub fn windows(&self, from: f64, length: f64) -> impl Iterator<Item = (f64, f64)> {
        let end = self.cells.last().map_or(from, |last| last.0);
        let count = ((end - from) / length).max(0.0) as u32;
        (0..count).map(move |k| {
            let start = from + f64::from(k) * length;
            (start, start + length)
        })
    }
}
