//! The estimator's own filter: its structured step over a cell and its two updates, without what
//! surrounds them (the vehicle's forces, noise switching, gates).

use super::Real;
use super::model::Meter;
use core::hint::black_box;
use estimator_core::filter::state::{ENERGY, STATES, State};
use estimator_core::filter::transition::Transition;
use estimator_core::filter::update::{Observation, Update};
use estimator_core::filter::{Covariance, Felt};
use estimator_core::sampler::{Circumstances, Sample};
use estimator_core::vehicle::{Load, STANDARD_AIR_DENSITY};
use estimator_core::{CELL_LENGTH_M, Effects, Place, Traction, Tuning, VehicleParameters};

/// All its states, on a level road at 20 m/s.
pub fn ours(meter: &mut impl Meter) {
    let vehicle = VehicleParameters {
        mass_kg: 39_000.0,
        drag_area_m2: 6.0,
        rolling_resistance: 0.0065,
        wheel_radius_m: 0.5,
        wheel_inertia_kgm2: 100.0,
        effects: Effects::default(),
        traction: Traction::Force,
    };
    let sample = Sample {
        place: Place::default(),
        gap_cells: 0,
        length_m: CELL_LENGTH_M,
        duration_s: CELL_LENGTH_M / 20.0,
        load: Load {
            traction_n: 3_956.0,
            rotating_kg: 400.0,
            mass_kg: 39_000.0,
            air_density: STANDARD_AIR_DENSITY,
        },
        circumstances: Circumstances::default(),
        speed: None,
        altitude: None,
        reopened: false,
    };
    let tuning = Tuning::default();
    let transition = Transition::new(&vehicle, &tuning, &sample, None, 1.0, Felt::default());
    let mut covariance = Covariance::ZERO;
    for i in 0..STATES {
        covariance.add_variance(i, 1.0);
    }
    let mut state = State::<Real> {
        x: [0.0; STATES],
        p: covariance,
        load: 0.0,
        origin_m: Some(0.0),
    };
    state.x[ENERGY] = 200.0;
    let transition = black_box(transition);
    let bytes = size_of_val(&state) + size_of_val(&transition);
    meter.measure(bytes, |[speed_mps, altitude_m]| {
        transition.predict(&mut state);
        let innovation = 0.5 * speed_mps * speed_mps - state.x[ENERGY];
        let _ = Update {
            observation: Observation::Energy,
            innovation,
            variance: 4.0,
        }
        .apply(&mut state);
        let seen_m = Observation::Altitude.of(&state.x);
        let _ = Update {
            observation: Observation::Altitude,
            innovation: altitude_m - seen_m,
            variance: 4.0,
        }
        .apply(&mut state);
        state.x
    });
}
