//! The model of the filter as dense matrices, written down independently.

use crate::truck;
use estimator_core::Tuning;
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

/// Returns the transition matrix and the process noise of one sample. The model is eq. 9 in
/// e = v²/2 over one cell, with the slope at its middle and Gauss-Markov slow states.
pub fn dense_model(
    sample: &Sample,
    net_traction: (f64, f64),
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
    let change = net_traction.1 - net_traction.0;
    let limit = f64::from(tuning.process_noise.traction_change_percent);
    let jump = change - change.clamp(-limit, limit);
    f[(ENERGY, ENERGY)] = energy;
    f[(ENERGY, SLOPE)] = -gravity * energy;
    f[(ENERGY, SLOPE_RATE)] = -gravity * 0.5 * length * energy;
    f[(ENERGY, SCALE)] = gravity * jump * energy;
    f[(ALTITUDE, SLOPE)] = length / 100.0;
    f[(ALTITUDE, SLOPE_RATE)] = length * 0.5 * length / 100.0;
    f[(ALTITUDE, BIAS)] = -length / 100.0;
    f[(ALTITUDE, WIND)] = -length / 100.0;
    f[(ALTITUDE, SCALE)] = (net_traction.1 - jump) * length / 100.0;
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
    let bias_sigma = 100.0
        * ((f64::from(tuning.process_noise.bias_force_n) / weight).powi(2)
            + (f64::from(tuning.process_noise.bias_rolling)
                * f64::from(vehicle.rolling_resistance))
            .powi(2)
            + (f64::from(tuning.process_noise.bias_drag) * air_n / weight).powi(2))
        .sqrt();
    let model = if sample.end.condition.is_valid() {
        100.0 * f64::from(tuning.process_noise.force_noise_n) / weight
    } else {
        f64::from(tuning.process_noise.invalid_noise_percent)
    };
    let mut q = DVector::zeros(STATES);
    q[ENERGY] = (gravity * model).powi(2);
    q[SLOPE_RATE] = (1.0 - rate * rate) * f64::from(tuning.process_noise.slope_rate_sigma).powi(2);
    q[BIAS] = (1.0 - bias * bias) * bias_sigma * bias_sigma;
    let wind_sigma = f64::from(vehicle.drag_area_m2)
        * f64::from(sample.forces.air_density)
        * mps
        * f64::from(tuning.process_noise.wind_sigma_mps)
        / weight
        * 100.0;
    q[WIND] = (1.0 - wind * wind) * wind_sigma * wind_sigma;
    q[SCALE] = f64::from(tuning.process_noise.scale_walk_per_sqrt_km).powi(2) * length / 1000.0;
    q[GNSS_ERROR] =
        (1.0 - error * error) * f64::from(tuning.measurement_noise.gnss_error_sigma_m).powi(2);
    (f, input, q)
}
