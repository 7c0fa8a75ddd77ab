//! The longitudinal accelerometer of a drive, as evidence for missing forces.
//!
//! A sensor that reads motion and gravity needs no GNSS and no filter: the force balance divided by
//! the mass, less its reading, is what the model lacks. The errors of the sensor are unknowns beside
//! the amounts. Its offset has a part that is the same on all drives, and a part of each drive; the
//! body pitches under acceleration. The noise of blocks is that of each drive's own residuals, with
//! the missing forces still in it: the weight is on the safe side.

use super::collector::seconds;
use super::drive::LoggedDrive;
use super::evidence::{ForceColumn, SEGMENT_M, SegmentSums};
use super::judgement::{holds, model_slope_percent};
use crate::inertial_judge::Stretch;
use crate::numeric::statistics::quantile;
use estimator_core::sample::Sample;
use estimator_core::vehicle::GRAVITY;
use estimator_core::{CELL_LENGTH_M, Model};
use nalgebra::DVector;

/// Length of a block in which the model holds, m.
const BLOCK_M: f64 = 300.0;
/// Shortest block, as a part of [`BLOCK_M`], and how far one may stretch over cells in which the
/// model does not hold.
const SHORTEST: f64 = 0.5;
const LONGEST_M: f64 = 2.0 * BLOCK_M;
/// Standard deviation of what the offset changes from drive to drive, %: 1.5 thousandths of gravity.
/// A guess; sensors of vehicle dynamics promise ten times that over all temperatures.
const OFFSET_OF_DRIVE_PERCENT: f64 = 0.15;
/// Blocks further from the median than this are left out, in standard deviations: a log may have no
/// signal of the brakes.
const OUTLIER: f64 = 3.0;
/// Median absolute deviation of a normal distribution, in standard deviations.
const MAD: f64 = 0.6745;
/// Least noise of a block, %: that of the road, as `inertial_judge` has it.
const LEAST_NOISE_PERCENT: f64 = 0.1;

/// Standard deviations of the sensor's errors that are common to all drives: offset, %, and pitch,
/// as a part of the acceleration. Both are guesses: a controller of vehicle dynamics learns the zero
/// of its sensor over many drives.
pub(super) const ERROR_SIGMAS: [f64; 2] = [0.1, 0.3];

/// What the accelerometer tells of one cell.
#[derive(Clone, Copy, Debug)]
pub(super) struct SensedCell {
    /// The road of the cell, as the sensor shows it.
    pub(super) stretch: Stretch,
    /// Kinetic energies a kilogram at both ends, m²/s².
    energies: (f64, f64),
}

/// Returns what the accelerometer tells of each cell of a drive; `None` where it breaks off.
pub(super) fn cells(drive: &LoggedDrive) -> Vec<Option<SensedCell>> {
    let Some(profile) = &drive.accelerometer else {
        return vec![None; drive.samples.len()];
    };
    let at = |sample: &Sample| profile.at_time(seconds(sample.end.time));
    let mut before = None;
    drive
        .samples
        .iter()
        .map(|sample| {
            let energy = 0.5 * f64::from(sample.end.speed_mps).powi(2);
            let now = at(sample).map(|point| (point, energy));
            let from = std::mem::replace(&mut before, now).filter(|_| sample.gap_cells == 0);
            let ((from, from_energy), (to, to_energy)) = (from?, now?);
            Some(SensedCell {
                stretch: Stretch::between(&from, &to)?,
                energies: (from_energy, to_energy),
            })
        })
        .collect()
}

/// Returns the slope of the force balance less that of the accelerometer in each cell, %, where the
/// model holds. Both use the same speeds, so that these hardly matter.
pub(super) fn errors(
    drive: &LoggedDrive,
    model: &Model,
    sensed: &[Option<SensedCell>],
) -> Vec<Option<f64>> {
    let pairs = drive.samples.iter().zip(sensed);
    pairs
        .map(|(sample, sensed)| {
            let sensed = sensed.as_ref().filter(|_| holds(sample))?;
            let (from, to) = sensed.energies;
            let motion_mps2 = (to - from) / f64::from(sample.length_m);
            let slope = (sensed.stretch.reading_mps2() - motion_mps2) / f64::from(GRAVITY);
            Some(model_slope_percent(model, sample, sensed.energies) - 100.0 * slope)
        })
        .collect()
}

/// A block of cells in which the model holds.
struct Block {
    /// Index of its segment.
    segment: usize,
    /// Number of cells.
    count: f64,
    /// Mean error of the model, %.
    error_percent: f64,
    /// The same for one unit of each column, %.
    response: DVector<f64>,
}

/// Adds the evidence of a drive's accelerometer to the sums of its segments. `sensor_errors` are the
/// columns of the sensor's errors, which have no force.
pub(super) fn add_evidence(
    segments: &mut [SegmentSums],
    drive: &LoggedDrive,
    model: &Model,
    columns: &[ForceColumn],
    sensor_errors: [usize; 2],
) {
    let blocks = blocks(drive, model, columns, sensor_errors);
    let Some(noise_percent) = noise_percent(&blocks) else {
        return;
    };
    let middle = quantile(blocks.iter().map(|block| block.error_percent), 0.5);
    let whole = BLOCK_M / f64::from(CELL_LENGTH_M);
    let weight = |block: &Block| (block.count / whole).sqrt() / noise_percent;
    let usable: Vec<&Block> = blocks
        .iter()
        .filter(|block| (block.error_percent - middle).abs() * weight(block) <= OUTLIER)
        .collect();
    // The offset of this drive: a variance common to its blocks, taken out of their mean.
    let square: f64 = usable.iter().map(|block| weight(block).powi(2)).sum();
    let shrunk = 1.0 - 1.0 / (1.0 + OFFSET_OF_DRIVE_PERCENT.powi(2) * square).sqrt();
    let mut mean_error = 0.0;
    let mut mean_response = DVector::zeros(columns.len());
    for block in &usable {
        let part = weight(block).powi(2) / square;
        mean_error += part * block.error_percent;
        mean_response.axpy(part, &block.response, 1.0);
    }
    for block in usable {
        let weight = weight(block);
        let error = weight * (block.error_percent - shrunk * mean_error);
        let response = weight * (&block.response - shrunk * &mean_response);
        let Some(last) = segments.len().checked_sub(1) else {
            return;
        };
        let segment = &mut segments[block.segment.min(last)];
        segment.information.ger(1.0, &response, &response, 1.0);
        segment.score.axpy(error, &response, 1.0);
        segment.negative_log_likelihood += error * error;
    }
}

/// Returns the standard deviation of a block around the drive's median, %, from the median absolute
/// deviation; `None` without blocks.
fn noise_percent(blocks: &[Block]) -> Option<f64> {
    if blocks.len() < 2 {
        return None;
    }
    let errors = || blocks.iter().map(|block| block.error_percent);
    let middle = quantile(errors(), 0.5);
    let deviation = quantile(errors().map(|error| (error - middle).abs()), 0.5);
    Some((deviation / MAD).max(LEAST_NOISE_PERCENT))
}

fn blocks(
    drive: &LoggedDrive,
    model: &Model,
    columns: &[ForceColumn],
    sensor_errors: [usize; 2],
) -> Vec<Block> {
    let cell_m = f64::from(CELL_LENGTH_M);
    let sensed = cells(drive);
    let errors = errors(drive, model, &sensed);
    let mut found = Vec::new();
    let empty = || (0, 0.0, 0.0, DVector::zeros(columns.len()));
    let (mut first, mut count, mut error_sum, mut response) = empty();
    for (k, sample) in drive.samples.iter().enumerate() {
        if let (Some(error), Some(sensed)) = (errors[k], &sensed[k]) {
            count += 1.0;
            error_sum += error;
            let percent_per_n = f64::from(100.0 / sample.forces.weight_n());
            for (sum, column) in response.iter_mut().zip(columns) {
                *sum += percent_per_n * f64::from(column[k]);
            }
            let [offset, pitch] = sensor_errors;
            response[offset] += 1.0;
            response[pitch] += 100.0 * sensed.stretch.acceleration_mps2 / f64::from(GRAVITY);
        }
        let stretch_m = (k - first + 1) as f64 * cell_m;
        if count * cell_m < BLOCK_M && stretch_m < LONGEST_M {
            continue;
        }
        if count * cell_m >= SHORTEST * BLOCK_M {
            found.push(Block {
                segment: (first as f64 * cell_m / SEGMENT_M) as usize,
                count,
                error_percent: error_sum / count,
                response: response / count,
            });
        }
        (first, count, error_sum, response) = empty();
        first += k + 1;
    }
    found
}
