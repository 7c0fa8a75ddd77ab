//! The outcome of a drive with a fault: its errors, and the consistency of its sigmas.

use super::Frames;
use estimator_core::{Model, Scalar, Tuning};
use host_sim::files::run::RunRow;
use host_sim::files::truth::TruthRow;
use host_sim::numeric::series::linear;
use host_sim::recorder::{Recorder, SmoothedRun};
use host_sim::simulator::SimulatedRun;

/// Distance that is left out at both ends of a drive, m.
const ENDS_M: f64 = 500.0;
/// Distance after the end of a fault at which the estimate must have recovered, m.
pub const RECOVERY_M: f64 = 2_000.0;

/// Runs an estimator on frames and returns the smoothed run.
///
/// # Panics
/// Panics if the vehicle is impossible or a temporary file cannot be written.
#[must_use]
pub fn estimated<S: Scalar>(model: &Model, frames: Frames<'_>) -> SmoothedRun {
    let mut recorder = Recorder::<S>::new(model.clone(), Tuning::default())
        .expect("the simulator's vehicles can be");
    for frame in frames {
        recorder.on_frame(&frame);
    }
    recorder.finish().expect("room for a drive")
}

/// Returns whether every number in every row is finite, and every sigma positive.
#[must_use]
pub fn is_sound(rows: &[RunRow]) -> bool {
    rows.iter().all(|row| {
        let finite = [
            row.time_s,
            row.distance_m,
            row.grade_percent,
            row.lagged_grade_percent,
            row.live_grade_percent,
            row.speed_mps,
            row.bias_percent,
            row.scale,
            row.altitude_m.unwrap_or(0.0),
            row.altitude_sigma_m.unwrap_or(0.0),
        ];
        let sigmas = grades_and_sigmas(row).map(|(_, sigma)| sigma);
        finite.iter().all(|number| number.is_finite())
            && sigmas.iter().all(|sigma| sigma.is_finite() && *sigma > 0.0)
    })
}

/// Returns the grades with their sigmas: smoothed, lagged and live.
const fn grades_and_sigmas(row: &RunRow) -> [(f64, f64); 3] {
    [
        (row.grade_percent, row.grade_sigma_percent),
        (row.lagged_grade_percent, row.lagged_grade_sigma_percent),
        (row.live_grade_percent, row.live_grade_sigma_percent),
    ]
}

/// Returns whether a row is marked as suspect: smoothed, lagged and live.
fn marks(row: &RunRow) -> [bool; 3] {
    [row.consistent, row.lagged_consistent, row.live_consistent].map(|consistent| consistent == 0)
}

/// Which cells count.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Counted {
    /// All of them.
    All,
    /// Those that are not marked as suspect.
    Unmarked,
}

/// Errors over some cells of one or several drives: smoothed, lagged and live.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct CellErrors {
    cells: [usize; 3],
    squares: [f64; 3],
    normalised: [f64; 3],
}

impl CellErrors {
    fn add(&mut self, row: &RunRow, grade_percent: f64, counted: Counted) {
        let marks = marks(row);
        for (index, (value, sigma)) in grades_and_sigmas(row).into_iter().enumerate() {
            if counted == Counted::Unmarked && marks[index] {
                continue;
            }
            self.cells[index] += 1;
            let error = value - grade_percent;
            self.squares[index] += error * error;
            self.normalised[index] += (error / sigma).powi(2);
        }
    }

    fn merge(&mut self, other: &Self) {
        for index in 0..3 {
            self.cells[index] += other.cells[index];
            self.squares[index] += other.squares[index];
            self.normalised[index] += other.normalised[index];
        }
    }

    /// Returns the numbers of cells.
    #[must_use]
    pub const fn cells(&self) -> [usize; 3] {
        self.cells
    }

    /// Returns the RMS errors of grade, %; 0 without cells.
    #[must_use]
    pub fn rmse_percent(&self) -> [f64; 3] {
        self.means(&self.squares).map(f64::sqrt)
    }

    /// Returns the means of the squared errors over the stated variances.
    #[must_use]
    pub fn normalised(&self) -> [f64; 3] {
        self.means(&self.normalised)
    }

    fn means(&self, sums: &[f64; 3]) -> [f64; 3] {
        [0, 1, 2].map(|index| sums[index] / self.cells[index].max(1) as f64)
    }
}

/// Errors of a drive by phase: before a fault, from its start until [`RECOVERY_M`] after its end,
/// from there on, and over the whole drive.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Phases {
    /// Before the fault.
    pub before: CellErrors,
    /// During the fault and the recovery.
    pub during: CellErrors,
    /// After the recovery.
    pub after: CellErrors,
    /// The whole drive.
    pub whole: CellErrors,
}

impl Phases {
    /// Adds the errors of another drive.
    pub fn merge(&mut self, other: &Self) {
        self.before.merge(&other.before);
        self.during.merge(&other.during);
        self.after.merge(&other.after);
        self.whole.merge(&other.whole);
    }
}

/// The times of a fault, s from the first frame on.
#[derive(Clone, Copy, Debug)]
pub struct Times {
    /// Start and end.
    pub window_s: (f64, f64),
    /// How far the listener's clock is ahead of the truth's from the fault's start on, s.
    pub ahead_s: f64,
}

/// The truth of a drive, by time and by distance.
#[derive(Debug)]
pub struct TrueDrive {
    grades: Vec<(f64, f64)>,
    distances: Vec<(f64, f64)>,
}

impl TrueDrive {
    /// Returns the truth of a drive.
    #[must_use]
    pub fn new(run: &SimulatedRun) -> Self {
        let column = |of: fn(&TruthRow) -> f64| -> Vec<(f64, f64)> {
            run.truth.iter().map(|row| (row.time_s, of(row))).collect()
        };
        Self {
            grades: column(|row| row.grade_percent),
            distances: column(|row| row.distance_m),
        }
    }

    /// Returns the distance at a time, m.
    #[must_use]
    pub fn distance_m(&self, time_s: f64) -> f64 {
        linear(&self.distances, time_s).unwrap_or_else(|| self.length_m())
    }

    /// Returns the length of the drive, m.
    #[must_use]
    pub fn length_m(&self) -> f64 {
        self.distances
            .last()
            .map_or(0.0, |(_, distance_m)| *distance_m)
    }

    /// Returns the errors of a run by phase, over the cells that count. A cell is compared with the truth at the time at which
    /// the vehicle left it.
    #[must_use]
    pub fn phases(&self, rows: &[RunRow], times: &Times, counted: Counted) -> Phases {
        let (from_s, until_s) = times.window_s;
        let from_m = self.distance_m(from_s);
        let recovered_m = self.distance_m(until_s) + RECOVERY_M;
        let mut errors = [CellErrors::default(); 4];
        for row in rows {
            let late_s = row.time_s - times.ahead_s;
            let time_s = if late_s >= from_s { late_s } else { row.time_s };
            let distance_m = self.distance_m(time_s);
            let within = ENDS_M..self.length_m() - ENDS_M;
            let Some(grade_percent) =
                linear(&self.grades, time_s).filter(|_| within.contains(&distance_m))
            else {
                continue;
            };
            let phase = match distance_m {
                distance_m if distance_m < from_m => 0,
                distance_m if distance_m < recovered_m => 1,
                _ => 2,
            };
            errors[phase].add(row, grade_percent, counted);
            errors[3].add(row, grade_percent, counted);
        }
        let [before, during, after, whole] = errors;
        Phases {
            before,
            during,
            after,
            whole,
        }
    }
}
