//! The estimator's own filter: its structured step over a cell and its two updates, without the
//! vehicle's forces, noise switching and gates.

use super::Real;
use super::model::FilterMeter;
use core::hint::black_box;
use estimator_core::filter::measurement::{Observation, ScalarMeasurement};
use estimator_core::filter::predict::Prediction;
use estimator_core::filter::{Covariance, EffectContribution, State, StateIndex, StateVector};
use estimator_core::sample::{EffectInputs, ForceInputs, Sample};
use estimator_core::vehicle::STANDARD_AIR_DENSITY;
use estimator_core::{
    CELL_LENGTH_M, CellEnd, Context, Counters, Disagreement, Traction, Tuning, VehicleParameters,
};

/// Measures the filter with all its states, on a level road at 20 m/s.
pub fn ours(meter: &mut impl FilterMeter) {
    let vehicle = VehicleParameters {
        mass_kg: 39_000.0,
        drag_area_m2: 6.0,
        rolling_resistance: 0.0065,
        wheel_radius_m: 0.5,
        wheel_inertia_kgm2: 100.0,
        traction: Traction::Force,
    };
    let context = Context {
        model: vehicle.into(),
        tuning: Tuning::default(),
        counters: Counters::default(),
    };
    let sample = Sample {
        end: CellEnd::default(),
        gap_cells: 0,
        length_m: CELL_LENGTH_M,
        duration_s: CELL_LENGTH_M / 20.0,
        forces: ForceInputs {
            traction_n: 3_956.0,
            rotating_kg: 400.0,
            mass_kg: 39_000.0,
            air_density: STANDARD_AIR_DENSITY,
        },
        effect_inputs: EffectInputs::default(),
        speed: None,
        altitude: None,
        inertial: None,
        slope: None,
        after_load_change: false,
        after_stop: false,
        mass_is_reported: false,
        torque_rests: false,
        torque_rest: Default::default(),
        retarder_n: 0.0,
        service_braking: false,
        traction_late_s: 0.0,
        disagreement: Disagreement::default(),
        disagreeing_cells: 0,
    };
    let no_effects = EffectContribution::default();
    let prediction = Prediction::of_first_cell(&context, &sample, no_effects);
    let mut covariance = Covariance::ZERO;
    for state in StateIndex::ALL {
        covariance.add_variance(state, 1.0);
    }
    let mut state = State::<Real> {
        mean: StateVector::ZERO,
        covariance,
        net_traction: 0.0,
        origin_m: Some(0.0),
        doubt_variance: 0.0,
    };
    state.mean[StateIndex::KineticEnergy] = 200.0;
    let prediction = black_box(prediction);
    let bytes = size_of_val(&state) + size_of_val(&prediction);
    meter.measure(bytes, |[speed_mps, altitude_m]| {
        prediction.apply(&mut state);
        let energy = state.mean[StateIndex::KineticEnergy];
        let _ = ScalarMeasurement {
            observation: Observation::Energy,
            innovation: 0.5 * speed_mps * speed_mps - energy,
            variance: 4.0,
        }
        .apply(&mut state);
        let predicted_m = Observation::Altitude.of(&state.mean, state.net_traction);
        let _ = ScalarMeasurement {
            observation: Observation::Altitude,
            innovation: altitude_m - predicted_m,
            variance: 4.0,
        }
        .apply(&mut state);
        *state.mean.as_array()
    });
}
