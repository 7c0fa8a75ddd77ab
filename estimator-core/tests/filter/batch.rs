//! The batch solution of a drive: all states of all cells at once.

use estimator_core::Tuning;
use estimator_core::filter::measurement::{Observation, ScalarUpdate};
use estimator_core::filter::{Reset, STATES, StateIndex};
use estimator_core::sample::Sample;
use nalgebra::{DMatrix, DVector};
use proptest::prelude::*;
use test_kit::dense::{BIAS, LearnedByThen, SCALE, SLOPE, WIND, dense_model, motions};
use test_kit::{FilteredStep, altitude, sample, speed};

/// Observed states of a speed.
pub const SPEED: &[StateIndex] = &[StateIndex::KineticEnergy];
/// Observed states of a scale from before a stop.
const SCALE_BEFORE: &[StateIndex] = &[StateIndex::Scale];
/// Observed states of a GNSS altitude.
const GNSS_ALTITUDE: &[StateIndex] = &[StateIndex::Altitude, StateIndex::GnssError];

/// Returns the variance of a measurement of a sum of states, from its S and K: S (1 − h K).
pub fn measured_variance(update: &ScalarUpdate<f64>, states: &[StateIndex]) -> f64 {
    let known: f64 = states.iter().map(|state| update.gain[*state]).sum();
    update.innovation_variance * (1.0 - known)
}

/// Returns what the filter has learned by the end of each cell. The noise of the force follows the
/// products of successive normalised innovations of the speed.
fn learned(cells: &[FilteredStep<f64>], tuning: &Tuning) -> Vec<LearnedByThen> {
    let noise = &tuning.measurement_noise;
    let (mut force_ratio, mut last) = (1.0, 0.0);
    cells
        .iter()
        .map(|cell| {
            let input = &cell.record.smoother_input;
            if let Some(used) = input.speed
                && input.reset == Reset::None
                && cell.record.end.condition.is_valid()
            {
                let normalised = used.innovation / used.innovation_variance.sqrt();
                let product = (normalised * last).clamp(-3.0, 3.0);
                last = normalised;
                let followed = product - f64::from(noise.force_correlation);
                force_ratio *= 1.0 + f64::from(noise.force_ratio_gain) * followed;
                force_ratio = force_ratio.clamp(1.0, f64::from(noise.force_ratio_high));
            }
            LearnedByThen {
                force_ratio,
                scale: 1.0 + cell.state.mean[StateIndex::Scale],
                scale_sigma: cell.state.sigma(StateIndex::Scale),
            }
        })
        .collect()
}

/// Returns the variance that the scale gains over a stop: any load, as a part of the scale.
fn opened(before: &FilteredStep<f64>, tuning: &Tuning) -> f64 {
    let scale = 1.0 + before.state.mean[StateIndex::Scale];
    let any = f64::from(tuning.prior.open_scale_sigma) * scale;
    (any * any - before.state.covariance.variance(StateIndex::Scale)).max(0.0)
}

/// Returns slope and sigma of each cell, from the joint distribution of all states of all cells,
/// conditioned on all measurements at once.
pub fn batch(samples: &[Sample], cells: &[FilteredStep<f64>], tuning: &Tuning) -> Vec<(f64, f64)> {
    let n = samples.len();
    let size = n * STATES;
    let mut mean = DVector::zeros(size);
    let mut covariance = DMatrix::zeros(size, size);
    let motions = motions(samples, cells, tuning);
    let learned = learned(cells, tuning);
    let first = &cells[0].state;
    mean.rows_mut(0, STATES)
        .copy_from(&first.mean.to_nalgebra());
    covariance
        .view_mut((0, 0), (STATES, STATES))
        .copy_from(&first.covariance.to_nalgebra());
    for (k, sample) in samples.iter().enumerate().skip(1) {
        let mut known = learned[k - 1];
        let opened = if sample.after_stop {
            opened(&cells[k - 1], tuning)
        } else {
            0.0
        };
        known.scale_sigma = (known.scale_sigma.powi(2) + opened).sqrt();
        // A stop ends the net traction before it opens the load.
        let mut from = motions[k - 1];
        let mut release = DMatrix::<f64>::identity(STATES, STATES);
        if sample.after_stop {
            release[(SLOPE, SCALE)] = core::mem::take(&mut from.net_traction);
        }
        let (f, input, q) = dense_model(sample, (from, motions[k]), known, tuning);
        let moves = &f * &release;
        let (now, before) = (k * STATES, (k - 1) * STATES);
        let moved = &moves * mean.rows(before, STATES) + input;
        mean.rows_mut(now, STATES).copy_from(&moved);
        let cross = &moves * covariance.view((before, 0), (STATES, now));
        covariance
            .view_mut((now, 0), (STATES, now))
            .copy_from(&cross);
        covariance
            .view_mut((0, now), (now, STATES))
            .copy_from(&cross.transpose());
        let mut start = covariance
            .view((before, before), (STATES, STATES))
            .into_owned();
        start = &release * start * release.transpose();
        start[(SCALE, SCALE)] += opened;
        let within = &f * start * f.transpose() + DMatrix::from_diagonal(&q);
        covariance
            .view_mut((now, now), (STATES, STATES))
            .copy_from(&within);
    }
    let mut rows = Vec::new();
    // The scale that a load is compared with: of the file at the start, unless its mass is reported;
    // later the one before a stop. Of two in a row the first counts.
    let mut scale_before = (!samples[0].mass_is_reported).then_some(0.0);
    // The first state already contains the measurements of its cell.
    for (k, sample) in samples.iter().enumerate().skip(1) {
        let mut push = |states: &[StateIndex], value: f64, variance: f64| {
            let mut h = DVector::zeros(size);
            for state in states {
                h[k * STATES + *state as usize] = 1.0;
            }
            rows.push((h, value, variance));
        };
        if let (Some(speed), Some(used)) = (sample.speed, cells[k].record.smoother_input.speed) {
            let v = f64::from(speed.mean_mps);
            push(SPEED, 0.5 * v * v, measured_variance(&used, SPEED));
        }
        if sample.after_stop {
            scale_before.get_or_insert(cells[k - 1].state.mean[StateIndex::Scale]);
        }
        // The scale from before a stop, if it is taken here.
        if let Some((Observation::Scale, used)) = cells[k].record.smoother_input.second {
            let scale = scale_before.take().expect("a stop or a start");
            push(SCALE_BEFORE, scale, measured_variance(&used, SCALE_BEFORE));
        }
        // Altitudes that passed the gate, with the variance that was learned by then.
        if let (Some(altitude), Some(used)) = (
            sample.altitude,
            cells[k].record.smoother_input.altitude().copied(),
        ) {
            let origin = f64::from(cells[k].state.origin_m.unwrap());
            push(
                GNSS_ALTITUDE,
                f64::from(altitude.altitude_m) - origin,
                measured_variance(&used, GNSS_ALTITUDE),
            );
        }
        // A slope: its value is what the update made of the state.
        let slope_row = match cells[k].record.smoother_input.second {
            Some((Observation::RoadSlope, used)) => {
                Some((used, [1.0, -1.0, -1.0, motions[k].net_traction]))
            }
            Some((Observation::ModelSlope, used)) => Some((used, [1.0, 0.0, 0.0, 0.0])),
            _ => None,
        };
        if let Some((used, row)) = slope_row {
            let states = [SLOPE, BIAS, WIND, SCALE];
            let of = |values: &[f64; STATES]| -> f64 {
                states
                    .iter()
                    .zip(row)
                    .map(|(i, factor)| factor * values[*i])
                    .sum()
            };
            let known = of(used.gain.as_array());
            let value = of(cells[k].state.mean.as_array()) + (1.0 - known) * used.innovation;
            let mut h = DVector::zeros(size);
            for (i, factor) in states.into_iter().zip(row) {
                h[k * STATES + i] = factor;
            }
            rows.push((h, value, used.innovation_variance * (1.0 - known)));
        }
    }
    let h = DMatrix::from_fn(rows.len(), size, |i, j| rows[i].0[j]);
    let y = DVector::from_fn(rows.len(), |i, _| rows[i].1);
    let r = DMatrix::from_diagonal(&DVector::from_fn(rows.len(), |i, _| rows[i].2));
    let cross = &covariance * h.transpose();
    let solve = (&h * &cross + r).cholesky().unwrap();
    let posterior = &mean + &cross * solve.solve(&(y - &h * &mean));
    let spread = &covariance - &cross * solve.solve(&cross.transpose());
    (0..n)
        .map(|k| {
            let mut h = DVector::zeros(size);
            h[k * STATES + SLOPE] = 1.0;
            h[k * STATES + BIAS] = -1.0;
            h[k * STATES + WIND] = -1.0;
            h[k * STATES + SCALE] = motions[k].net_traction;
            (h.dot(&posterior), (h.transpose() * &spread * &h)[0].sqrt())
        })
        .collect()
}

/// A drive at about 20 m/s whose every measurement is random, altitude from the first cell on.
pub fn random_drive() -> impl Strategy<Value = Vec<Sample>> {
    let step = (
        -8_000.0..16_000.0_f32,
        19.9..20.1_f32,
        -1.5..1.5_f32,
        0..100_u8,
    );
    prop::collection::vec(step, 12..40).prop_map(|steps| {
        steps
            .iter()
            .enumerate()
            .map(|(k, (force, mps, metres, dice))| {
                let mut sample = sample(k as u32 + 1, *force, 20.0);
                if k == 0 || dice % 5 != 0 {
                    sample.speed = speed(*mps);
                }
                if k == 0 || dice % 7 == 0 {
                    sample.altitude = altitude(100.0 + metres);
                }
                sample.end.condition.braking = dice % 11 == 0;
                sample
            })
            .collect()
    })
}

/// Returns whether the speed of a cell was reset: its variance then contains its innovation squared.
pub fn has_speed_step(cell: &FilteredStep<f64>) -> bool {
    cell.record.smoother_input.speed.is_some_and(|used| {
        let square = used.innovation * used.innovation;
        let without = used.innovation_variance - square;
        (0.0..square / 25.0).contains(&without)
    })
}
