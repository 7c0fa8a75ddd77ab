//! Estimates and the bare model against the accelerometer, before and after, drive by drive.
//!
//! The accelerometer's offset is a part of each drive's mean difference. It is told, and removed
//! from the RMS. Sensor and estimates see the same windows; the estimates did not see the sensor.

use super::accelerometer::{SensedCell, cells, errors};
use super::drive::LoggedDrive;
use crate::files::run::RunRow;
use crate::numeric::slope::sine;
use crate::numeric::statistics::{deviation, mean, quantile};
use estimator_core::{CELL_LENGTH_M, Model};

/// Length of a window, m.
pub const WINDOW_M: f64 = 300.0;
/// Fraction of a window in which the model must hold, and the sensor must be known.
const VALID: f64 = 0.8;

/// Differences over the windows of one drive.
#[derive(Clone, Copy, Debug)]
pub struct DriveErrors {
    /// Mean, with the sensor's offset, %.
    pub mean_percent: f64,
    /// Root mean square without the mean, %.
    pub rms_percent: f64,
    /// Number of windows.
    pub windows: usize,
}

/// One drive against its accelerometer. What has no window is `None`.
#[derive(Clone, Debug)]
pub struct DriveAgainstSignal {
    /// Index of the drive among those judged.
    pub drive: usize,
    /// The bare model, where it holds.
    pub bare: Option<DriveErrors>,
    /// The smoothed grade.
    pub smoothed: Option<DriveErrors>,
    /// The lagged grade.
    pub lagged: Option<DriveErrors>,
    /// The live grade.
    pub live: Option<DriveErrors>,
}

/// Drives against their accelerometers.
#[derive(Clone, Debug, Default)]
pub struct SignalJudgement {
    /// Each drive that has one.
    pub drives: Vec<DriveAgainstSignal>,
}

/// What a drive has an estimate of.
pub type OfDrive = fn(&DriveAgainstSignal) -> Option<DriveErrors>;

/// What is judged, by the name in the report.
pub const JUDGED: [(&str, OfDrive); 4] = [
    ("bare", |drive| drive.bare),
    ("smoothed", |drive| drive.smoothed),
    ("lagged", |drive| drive.lagged),
    ("live", |drive| drive.live),
];

/// All drives in a few numbers.
#[derive(Clone, Copy, Debug)]
pub struct Overall {
    /// Mean of the drives' means, with the offset of the sensor, %.
    pub mean_percent: f64,
    /// Median of the drives' RMS, %.
    pub median_rms_percent: f64,
    /// The RMS that nine drives in ten are below, %.
    pub ninth_rms_percent: f64,
}

impl SignalJudgement {
    /// Judges drives that were read with `model`.
    #[must_use]
    pub fn of(drives: &[LoggedDrive], model: &Model) -> Self {
        let drives = drives.iter().enumerate();
        let sensed = drives.filter(|(_, drive)| drive.accelerometer.is_some());
        Self {
            drives: sensed
                .map(|(number, drive)| against_signal(number, drive, model))
                .collect(),
        }
    }

    /// Returns the drives in a few numbers; `None` if none has a window.
    #[must_use]
    pub fn overall(&self, of: OfDrive) -> Option<Overall> {
        let errors: Vec<DriveErrors> = self.drives.iter().filter_map(of).collect();
        let means: Vec<f64> = errors.iter().map(|errors| errors.mean_percent).collect();
        let rms = || errors.iter().map(|errors| errors.rms_percent);
        (!errors.is_empty()).then(|| Overall {
            mean_percent: mean(&means),
            median_rms_percent: quantile(rms(), 0.5),
            ninth_rms_percent: quantile(rms(), 0.9),
        })
    }
}

fn against_signal(number: usize, drive: &LoggedDrive, model: &Model) -> DriveAgainstSignal {
    let sensed = cells(drive);
    let of_grade = |grade: fn(&RunRow) -> f64| {
        let rows = drive.run.rows.iter().zip(&sensed);
        let differences = rows.map(|(row, cell)| {
            let cell: &SensedCell = cell.as_ref()?;
            Some(100.0 * (sine(0.01 * grade(row)) - cell.stretch.sine()))
        });
        drive_errors(differences)
    };
    DriveAgainstSignal {
        drive: number,
        bare: drive_errors(errors(drive, model, &sensed).into_iter()),
        smoothed: of_grade(|row| row.grade_percent),
        lagged: of_grade(|row| row.lagged_grade_percent),
        live: of_grade(|row| row.live_grade_percent),
    }
}

/// Returns the errors over the windows of cells that have enough differences (%).
fn drive_errors(differences: impl Iterator<Item = Option<f64>>) -> Option<DriveErrors> {
    let differences: Vec<Option<f64>> = differences.collect();
    let cells = (WINDOW_M / f64::from(CELL_LENGTH_M)) as usize;
    let windows: Vec<f64> = differences
        .chunks_exact(cells)
        .filter_map(|window| {
            let known: Vec<f64> = window.iter().copied().flatten().collect();
            (known.len() as f64 >= VALID * cells as f64).then(|| mean(&known))
        })
        .filter(|error| error.is_finite())
        .collect();
    (!windows.is_empty()).then(|| DriveErrors {
        mean_percent: mean(&windows),
        rms_percent: deviation(&windows),
        windows: windows.len(),
    })
}
