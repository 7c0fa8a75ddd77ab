//! Evidence of drives for forces that the model lacks.
//!
//! The filter is linear: a missing force that is proportional to an unknown amount moves its
//! normalised innovations by that amount times a known response. With the right model, innovations
//! are white and of unit variance on any road. Amounts therefore follow from them by least squares.
//! The filter's weights account for the errors of GNSS, wind, road and slow bias. These are the
//! generalised least squares estimates, and the gain in fit is the likelihood ratio (Rosenberg
//! 1973; de Jong 1991).
//!
//! Real errors have longer correlation than any model of them. The sums are therefore kept for each
//! segment of a drive. Their scatter from segment to segment gives the variance of an estimate (a
//! sandwich estimator with clusters: H. White, "Maximum likelihood estimation of misspecified
//! models", Econometrica 50:1, 1982).

use super::drive::LoggedDrive;
use crate::smooth::Piece;
use estimator_core::filter::{Record, STATES, Update, VehicleCells};
use estimator_core::vehicle::GRAVITY;
use estimator_core::{CELL_LENGTH_M, Context, Counters, Model, Tuning};
use nalgebra::{DMatrix, DVector};

/// Length of a segment, m.
pub(super) const SEGMENT_M: f64 = 4_000.0;

/// Missing force (N) in each cell of a drive, for one unit of an amount.
pub type ForceColumn = Vec<f32>;

/// Sums over one segment of a drive: of response times response, and of response times innovation.
#[derive(Clone, Debug)]
pub struct SegmentSums {
    /// Index of the drive.
    pub drive: usize,
    /// Sum of response times response.
    pub information: DMatrix<f64>,
    /// Sum of response times innovation.
    pub score: DVector<f64>,
    /// Minus twice the log likelihood of the altitudes without any missing force, but for a
    /// constant.
    pub negative_log_likelihood: f64,
}

/// All segments of all drives.
#[derive(Clone, Debug, Default)]
pub struct Evidence {
    /// In the order of the drives.
    pub segments: Vec<SegmentSums>,
}

impl FromIterator<SegmentSums> for Evidence {
    fn from_iter<I: IntoIterator<Item = SegmentSums>>(segments: I) -> Self {
        Self {
            segments: segments.into_iter().collect(),
        }
    }
}

/// Tried standard deviations of the wind, m/s.
pub const WINDS_MPS: [f32; 5] = [0.1, 0.2, 0.4, 0.8, 1.6];

/// Rounds in which the variances of road, receiver and force are inferred.
const ROUNDS: usize = 6;

/// Returns the tuning of the filter for the search. Errors that are the same on all drives are
/// candidates of the search. The filter's own slow states therefore have only the variance of what
/// differs from drive to drive and along a drive, such as wind. The bias has no steps, and neither slip
/// nor retarder are learned: they would take the place of the effects that are searched for.
#[must_use]
pub fn judging_tuning(estimator: &Tuning, wind_noise_mps: f32) -> Tuning {
    let mut tuning = estimator.clone();
    let numbers = &mut tuning.estimation;
    numbers.wind_noise_mps = wind_noise_mps;
    numbers.bias_force_n = 20.0;
    numbers.bias_resistance = 0.01;
    numbers.bias_length_m = 20_000.0;
    numbers.traction_noise = 0.0;
    numbers.prior_cold_tyre = 0.0;
    numbers.prior_scale = 0.02;
    numbers.prior_tyre_slip = 0.0;
    numbers.prior_retarder = 0.0;
    numbers.bias_shock_most_percent = 0.0;
    numbers.start_shock_percent = 1e-3;
    tuning
}

/// Returns the sums of a drive for the forces in `columns`, one for each segment.
#[must_use]
pub fn segments(
    drive: usize,
    logged: &LoggedDrive,
    model: &Model,
    tuning: &Tuning,
    columns: &[ForceColumn],
) -> Vec<SegmentSums> {
    let context = Context {
        model: model.clone(),
        tuning: tuning.clone(),
        counters: Counters::default(),
    };
    let (mut piece, mut maker) = (Piece::default(), VehicleCells::default());
    for sample in &logged.samples {
        piece.push(&context, None, &mut maker, sample, true);
    }
    // A load that is wrong on all drives is a candidate.
    if let Some(first) = piece.cells.first_mut() {
        first.load_variance = 0.0;
    }
    let mut errors = vec![[0.0; STATES]; columns.len()];
    let mut response = DVector::zeros(columns.len());
    let empty = || SegmentSums {
        drive,
        information: DMatrix::zeros(columns.len(), columns.len()),
        score: DVector::zeros(columns.len()),
        negative_log_likelihood: 0.0,
    };
    let mut found = Vec::new();
    let mut segment = empty();
    let mut length_m = 0.0;
    let before_speed = logged.samples.len() - piece.cells.len();
    let samples = &logged.samples[before_speed..];
    let Some(mut inferred) = piece.infer_quickly(&tuning.estimation, ROUNDS) else {
        return Vec::new();
    };
    inferred.forward(|index, cell, terms, record| {
        let weight_n = samples[index].forces.mass_kg * GRAVITY;
        let per_newton = f64::from(CELL_LENGTH_M / weight_n);
        for (j, (error, column)) in errors.iter_mut().zip(columns).enumerate() {
            let missing_m = f64::from(column[before_speed + index]) * per_newton;
            response[j] = record
                .carry_error(cell, &terms.dynamics, error, missing_m)
                .unwrap_or(0.0);
        }
        segment.take(record, &response);
        length_m += f64::from(CELL_LENGTH_M);
        if length_m >= SEGMENT_M {
            found.push(std::mem::replace(&mut segment, empty()));
            length_m = 0.0;
        }
    });
    found.push(segment);
    found
}

impl Evidence {
    /// Returns the sums over all segments of the selected drives.
    #[must_use]
    pub fn sums(&self, counts: impl Fn(usize) -> bool) -> (DMatrix<f64>, DVector<f64>) {
        let size = self.segments.first().map_or(0, |s| s.score.len());
        let mut sums = (DMatrix::zeros(size, size), DVector::zeros(size));
        for segment in self.segments.iter().filter(|s| counts(s.drive)) {
            sums.0 += &segment.information;
            sums.1 += &segment.score;
        }
        sums
    }
}

impl SegmentSums {
    fn take(&mut self, record: &Record<f64>, response: &DVector<f64>) {
        let Some(applied) = record.altitude.as_ref().and_then(Update::used) else {
            return;
        };
        let per_variance = 1.0 / applied.innovation_variance;
        self.negative_log_likelihood +=
            applied.innovation.powi(2) * per_variance + applied.innovation_variance.ln();
        self.information.ger(per_variance, response, response, 1.0);
        self.score
            .axpy(applied.innovation * per_variance, response, 1.0);
    }
}
