//! The model of the filter as dense matrices, written down independently.

use crate::{FilteredStep, truck};
use estimator_core::Tuning;
use estimator_core::filter::measurement::Observation;
use estimator_core::filter::{STATES, StateIndex};
use estimator_core::sample::Sample;
use nalgebra::{DMatrix, DVector};

/// Positions of the states in dense matrices.
pub const ENERGY: usize = StateIndex::KineticEnergy as usize;
pub const ALTITUDE: usize = StateIndex::Altitude as usize;
pub const SLOPE: usize = StateIndex::Slope as usize;
pub const SLOPE_RATE: usize = StateIndex::SlopeRate as usize;
pub const BIAS: usize = StateIndex::Bias as usize;
pub const WIND: usize = StateIndex::Wind as usize;
pub const SCALE: usize = StateIndex::Scale as usize;
pub const GNSS_ERROR: usize = StateIndex::GnssError as usize;

/// What a filter has learned by the start of a cell, and its noise depends on.
#[derive(Clone, Copy, Debug)]
pub struct LearnedByThen {
    /// Variance of the white noise of the force over the assumed one.
    pub force_ratio: f64,
    /// Scale of the traction: modelled over true mass.
    pub scale: f64,
    /// Its sigma. It decides which changes of traction show the scale.
    pub scale_sigma: f64,
}

/// Returns the net traction of each cell in %: traction less air resistance, over weight. It is
/// held while the model is invalid.
pub fn net_tractions(samples: &[Sample]) -> Vec<f64> {
    let mut held = None;
    samples
        .iter()
        .map(|sample| {
            let weight = f64::from(sample.forces.mass_kg) * 9.806_65;
            let mps = f64::from(sample.end.speed_mps);
            let air_n = 0.5
                * f64::from(truck().drag_area_m2)
                * f64::from(sample.forces.air_density)
                * mps
                * mps;
            let now = 100.0 * (f64::from(sample.forces.traction_n) - air_n) / weight;
            let net_traction = match held {
                Some(held) if !sample.end.condition.is_valid() => held,
                _ => now,
            };
            held = Some(net_traction);
            net_traction
        })
        .collect()
}

/// A cell as the model moves over it.
#[derive(Clone, Copy, Debug)]
pub struct Motion {
    /// Net traction at its end, %.
    pub net_traction: f64,
    /// Whether the vehicle launches with an open load: it gains speed faster than a road lets it.
    pub launches: bool,
}

/// Returns the motion over each cell. What turns engine and wheels does not move the mass: it is no
/// net traction. The speed gained is counted from what the filter knew at the start of the cell. A
/// stop opens the load, until it is compared with the one before, and ends the net traction; the drive
/// itself begins in motion.
pub fn motions(samples: &[Sample], cells: &[FilteredStep<f64>], tuning: &Tuning) -> Vec<Motion> {
    let mut held = None;
    let mut driven_m = None;
    let gross = net_tractions(samples);
    (0..samples.len())
        .map(|k| {
            let sample = &samples[k];
            let is_valid = sample.end.condition.is_valid();
            let length = f64::from(sample.length_m);
            let gained = if k == 0 {
                0.0
            } else {
                let mps = f64::from(sample.end.speed_mps);
                let before = cells[k - 1].state.mean[StateIndex::KineticEnergy];
                (0.5 * mps * mps - before) / length
            };
            let weight = f64::from(sample.forces.mass_kg) * 9.806_65;
            let turning = 100.0 * f64::from(sample.forces.rotating_kg) * gained / weight;
            if sample.after_stop {
                held = Some(0.0);
            }
            let net_traction = match held {
                Some(held) if !is_valid => held,
                _ => gross[k] - turning,
            };
            held = Some(net_traction);
            if sample.after_stop {
                driven_m = Some(0.0);
            }
            let longest = f64::from(tuning.prior.launch_longest_m);
            let is_open = driven_m.is_some_and(|metres| metres < longest);
            if let Some((Observation::Scale, _)) = cells[k].record.smoother_input.second {
                driven_m = None;
            } else if is_valid {
                driven_m = driven_m.map(|metres| metres + length);
            }
            Motion {
                net_traction,
                launches: is_open && gained > f64::from(tuning.process_noise.launch_mps2),
            }
        })
        .collect()
}

/// Returns the transition matrix and the process noise of one sample. The model is eq. 9 in
/// e = v²/2 over one cell, with the slope at its middle and Gauss-Markov slow states.
pub fn dense_model(
    sample: &Sample,
    (before, now): (Motion, Motion),
    learned: LearnedByThen,
    tuning: &Tuning,
) -> (DMatrix<f64>, DVector<f64>, DVector<f64>) {
    let vehicle = truck();
    let mass = f64::from(sample.forces.mass_kg);
    let length = f64::from(sample.length_m);
    let accelerated = mass + f64::from(sample.forces.rotating_kg);
    let g = 9.806_65;
    let drag = f64::from(vehicle.drag_area_m2) * f64::from(sample.forces.air_density) / accelerated
        * length;
    let gravity = mass * g / accelerated * length / 100.0;
    let rolling = mass * g * f64::from(vehicle.rolling_resistance) / accelerated * length;
    let traction = f64::from(sample.forces.traction_n) / accelerated * length;
    let keep = |ratio: f64| 1.0 / (1.0 + ratio);
    let energy = 1.0 - drag + 0.5 * drag * drag;

    let mut f = DMatrix::<f64>::identity(STATES, STATES);
    let change = now.net_traction - before.net_traction;
    let limit = f64::from(tuning.process_noise.traction_change_percent);
    let beyond = change - change.clamp(-limit, limit);
    let shows = f64::from(tuning.process_noise.jump_matters_percent);
    let jump = if now.launches {
        change
    } else if learned.scale_sigma * beyond.abs() > shows {
        beyond
    } else {
        0.0
    };
    f[(ENERGY, ENERGY)] = energy;
    f[(ENERGY, SLOPE)] = -gravity * energy;
    f[(ENERGY, SLOPE_RATE)] = -gravity * 0.5 * length * energy;
    f[(ENERGY, SCALE)] = gravity * jump * energy;
    f[(ALTITUDE, SLOPE)] = length / 100.0;
    f[(ALTITUDE, SLOPE_RATE)] = length * 0.5 * length / 100.0;
    f[(ALTITUDE, BIAS)] = -length / 100.0;
    f[(ALTITUDE, WIND)] = -length / 100.0;
    f[(ALTITUDE, SCALE)] = (now.net_traction - jump) * length / 100.0;
    f[(SLOPE, SLOPE_RATE)] = length;
    f[(SLOPE, SCALE)] = -jump;
    let rate = keep(length / f64::from(tuning.process_noise.slope_rate_length_m));
    let bias = keep(length / f64::from(tuning.process_noise.bias_length_m));
    let wind = keep(length / f64::from(tuning.process_noise.wind_length_m));
    let error =
        keep(f64::from(sample.duration_s) / f64::from(tuning.measurement_noise.gnss_error_time_s));
    f[(SLOPE_RATE, SLOPE_RATE)] = rate;
    f[(BIAS, BIAS)] = bias;
    f[(WIND, WIND)] = wind;
    f[(GNSS_ERROR, GNSS_ERROR)] = error;

    let mut input = DVector::zeros(STATES);
    input[ENERGY] = traction - rolling;

    let weight = mass * g;
    let mps = f64::from(sample.end.speed_mps);
    let air_n =
        0.5 * f64::from(vehicle.drag_area_m2) * f64::from(sample.forces.air_density) * mps * mps;
    // A force weighs more on a vehicle that is lighter than its model.
    let lighter = learned.scale.clamp(0.2, 5.0);
    let bias_sigma = 100.0
        * ((lighter * f64::from(tuning.process_noise.bias_force_n) / weight).powi(2)
            + (f64::from(tuning.process_noise.bias_rolling)
                * f64::from(vehicle.rolling_resistance))
            .powi(2)
            + (lighter * f64::from(tuning.process_noise.bias_drag) * air_n / weight).powi(2))
        .sqrt();
    let model = if sample.end.condition.is_valid() {
        let white = lighter * 100.0 * f64::from(tuning.process_noise.force_noise_n) / weight;
        // The part of the traction that turns wheels and engine.
        let turning_n = f64::from(sample.forces.traction_n) * f64::from(sample.forces.rotating_kg)
            / accelerated;
        let turning = 100.0 * f64::from(tuning.process_noise.inertia_noise) * turning_n / weight;
        learned.force_ratio * white * white + turning * turning
    } else {
        f64::from(tuning.process_noise.invalid_noise_percent).powi(2)
    };
    let jump_noise = f64::from(tuning.process_noise.jump_noise) * jump;
    let mut q = DVector::zeros(STATES);
    q[ENERGY] = gravity * gravity * (model + jump_noise * jump_noise);
    q[SLOPE_RATE] = (1.0 - rate * rate) * f64::from(tuning.process_noise.slope_rate_sigma).powi(2);
    q[BIAS] = (1.0 - bias * bias) * bias_sigma * bias_sigma;
    let wind_sigma = f64::from(vehicle.drag_area_m2)
        * f64::from(sample.forces.air_density)
        * mps
        * f64::from(tuning.process_noise.wind_sigma_mps)
        * lighter
        / weight
        * 100.0;
    q[WIND] = (1.0 - wind * wind) * wind_sigma * wind_sigma;
    q[SCALE] = f64::from(tuning.process_noise.scale_walk_per_sqrt_km).powi(2) * length / 1000.0;
    // What a launch shows together keeps a sigma.
    if now.launches && jump != 0.0 {
        let least = f64::from(tuning.process_noise.jump_scale_sigma) * learned.scale;
        q[SCALE] += (least.powi(2) - learned.scale_sigma.powi(2)).max(0.0);
    }
    q[GNSS_ERROR] =
        (1.0 - error * error) * f64::from(tuning.measurement_noise.gnss_error_sigma_m).powi(2);
    (f, input, q)
}
