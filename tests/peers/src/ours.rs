//! The estimator's own filter: its structured step over a cell and its two updates, without the
//! vehicle's forces and the inference of variances.

use super::Real;
use super::model::FilterMeter;
use core::hint::black_box;
use estimator_core::CELL_LENGTH_M;
use estimator_core::filter::{
    CellInput, CellNoise, Dynamics, Marks, NOISES, Reading, Record, State, StateIndex,
};

#[allow(clippy::unnecessary_cast, reason = "the number is single or double")]
/// Measures the filter with all its states, on a level road at 20 m/s.
pub fn ours(meter: &mut impl FilterMeter) {
    let speed_mps = 20.0;
    let cell = CellInput {
        duration_s: CELL_LENGTH_M / speed_mps,
        speed_mps,
        keep_energy: 0.999,
        work: 0.2,
        gravity: 0.245,
        net_traction_percent: 1.0,
        traction_jump_percent: 0.0,
        retarder_percent: 0.0,
        retarder_step_percent: 0.0,
        force_variance: 1e-3,
        fixed_force_variance: 0.0,
        bias_variance: 0.01,
        load_variance: 0.0,
        effect_variance: 0.0,
        wind_variance: 0.01,
        energy: Reading::NONE,
        energy_behind_m: 0.0,
        since_speed_m: CELL_LENGTH_M,
        energy_per_slip: 4.0,
        altitude: Reading::NONE,
        altitude_behind_m: 0.0,
        slope: Reading::NONE,
        rest_percent: 0.0,
        marks: Marks::default(),
    };
    let dynamics = black_box(Dynamics::<Real> {
        keep_energy: 0.999,
        gravity: 0.245,
        net_traction: 1.0,
        traction_jump: 0.0,
        retarder: 0.0,
        retarder_step: 0.0,
        keep_slope_rate: 0.98,
        keep_bias: 1.0,
        keep_wind: 0.997,
        keep_slow_gnss_error: 0.999,
        keep_fast_gnss_error: 0.98,
        ends_doubt: false,
    });
    let noise = black_box(CellNoise::<Real> {
        of: [1e-3; NOISES],
        load: 0.0,
        speed: 4.0,
        altitude: 4.0,
        slope: 4.0,
    });
    let (mut state, mut record) = (State::<Real>::ZERO, Record::EMPTY);
    for index in StateIndex::ALL {
        state.covariance.add(index, index, 1.0);
    }
    state.mean[StateIndex::KineticEnergy as usize] = 200.0;
    let bytes = size_of_val(&state) + size_of_val(&dynamics) + size_of_val(&noise);
    meter.measure(bytes, |[speed_mps, altitude_m]| {
        let reading = |value: Real| Reading {
            value: value as f32,
            variance: 4.0,
        };
        let cell = CellInput {
            energy: reading(0.5 * speed_mps * speed_mps),
            altitude: reading(altitude_m),
            ..cell
        };
        state.step(&cell, &dynamics, &noise, None, &mut record);
        state.mean
    });
}
