//! What became of a drive with a fault: its errors, how honest its sigmas were, what was counted.

use super::Frames;
use estimator_core::{Model, Scalar, Tuning};
use host_sim::files::run::RunRow;
use host_sim::files::truth::TruthRow;
use host_sim::numeric::series::linear;
use host_sim::recorder::{Recorder, SmoothedRun};
use host_sim::simulator::SimulatedRun;

/// Ways at both ends of a drive that are left out, m.
const ENDS_M: f64 = 500.0;
/// Way after a fault's end from which it is to be over, m.
pub const RECOVERY_M: f64 = 2_000.0;

/// Returns what an estimator made of frames.
///
/// # Panics
/// With a vehicle that there cannot be, or without room for what it drives.
#[must_use]
pub fn estimated<S: Scalar>(model: &Model, frames: Frames<'_>) -> SmoothedRun {
    let mut recorder = Recorder::<S>::new(model.clone(), Tuning::default())
        .expect("the simulator's vehicles can be");
    for frame in frames {
        recorder.on_frame(&frame);
    }
    recorder.finish().expect("room for a drive")
}

/// Returns whether every number in every row is one, and every sigma above nought.
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
        let sigmas = looks(row).map(|(_, sigma)| sigma);
        finite.iter().all(|number| number.is_finite())
            && sigmas.iter().all(|sigma| sigma.is_finite() && *sigma > 0.0)
    })
}

/// Returns grade and sigma: smoothed, lagged and live.
const fn looks(row: &RunRow) -> [(f64, f64); 3] {
    [
        (row.grade_percent, row.grade_sigma_percent),
        (row.lagged_grade_percent, row.lagged_grade_sigma_percent),
        (row.live_grade_percent, row.live_grade_sigma_percent),
    ]
}

/// Errors over some cells, of one drive or several: smoothed, lagged and live.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct CellErrors {
    cells: usize,
    squares: [f64; 3],
    normalised: [f64; 3],
}

impl CellErrors {
    fn add(&mut self, row: &RunRow, grade_percent: f64) {
        self.cells += 1;
        for (index, (value, sigma)) in looks(row).into_iter().enumerate() {
            let error = value - grade_percent;
            self.squares[index] += error * error;
            self.normalised[index] += (error / sigma).powi(2);
        }
    }

    fn merge(&mut self, other: &Self) {
        self.cells += other.cells;
        for index in 0..3 {
            self.squares[index] += other.squares[index];
            self.normalised[index] += other.normalised[index];
        }
    }

    /// Cells that they are of.
    #[must_use]
    pub const fn cells(&self) -> usize {
        self.cells
    }

    /// Roots of the mean squared errors of grade, %.
    #[must_use]
    pub fn rmse_percent(&self) -> [f64; 3] {
        self.squares
            .map(|sum| (sum / self.cells.max(1) as f64).sqrt())
    }

    /// Means of the squared errors over the stated variances.
    #[must_use]
    pub fn normalised(&self) -> [f64; 3] {
        self.normalised.map(|sum| sum / self.cells.max(1) as f64)
    }
}

/// Errors of a drive by when: before a fault; from its start until [`RECOVERY_M`] behind its end;
/// from there on; and over all.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Phases {
    /// Before it.
    pub before: CellErrors,
    /// With it, and on the way on which it is to be got over.
    pub during: CellErrors,
    /// After that.
    pub after: CellErrors,
    /// All of the drive.
    pub whole: CellErrors,
}

impl Phases {
    /// Takes in those of another drive.
    pub fn merge(&mut self, other: &Self) {
        self.before.merge(&other.before);
        self.during.merge(&other.during);
        self.after.merge(&other.after);
        self.whole.merge(&other.whole);
    }
}

/// When a fault was, in seconds from the first frame on.
#[derive(Clone, Copy, Debug)]
pub struct Times {
    /// From a time until another.
    pub window_s: (f64, f64),
    /// What the listener's clock is ahead of the truth's from the fault's start on, s.
    pub ahead_s: f64,
}

/// A drive as it was, by time and by distance.
#[derive(Debug)]
pub struct TrueDrive {
    grades: Vec<(f64, f64)>,
    distances: Vec<(f64, f64)>,
}

impl TrueDrive {
    /// Of a drive.
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

    /// Returns how far the drive had come at a time, m.
    #[must_use]
    pub fn distance_m(&self, time_s: f64) -> f64 {
        linear(&self.distances, time_s).unwrap_or_else(|| self.length_m())
    }

    /// Returns all of it, m.
    #[must_use]
    pub fn length_m(&self) -> f64 {
        self.distances
            .last()
            .map_or(0.0, |(_, distance_m)| *distance_m)
    }

    /// Compares a run with it. Cells are where the vehicle truly was when they ended.
    #[must_use]
    pub fn phases(&self, rows: &[RunRow], times: &Times) -> Phases {
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
            errors[phase].add(row, grade_percent);
            errors[3].add(row, grade_percent);
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
