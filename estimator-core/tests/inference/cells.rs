//! Cells for the tests.

use estimator_core::filter::{CellInput, Marks, Reading};
use proptest::prelude::*;

/// A truck of 20 t at 20 m/s on a level road.
pub const LEVEL: CellInput = CellInput {
    duration_s: 0.125,
    speed_mps: 20.0,
    keep_energy: 0.9995,
    work: 0.0,
    gravity: 0.245,
    net_traction_percent: 1.0,
    traction_jump_percent: 0.0,
    retarder_percent: 0.0,
    retarder_step_percent: 0.0,
    force_variance: 0.004,
    fixed_force_variance: 0.0,
    load_variance: 0.0,
    bias_variance: 0.02,
    effect_variance: 0.0,
    wind_variance: 0.003,
    energy: Reading {
        value: 200.0,
        variance: 0.05,
    },
    energy_behind_m: 1.0,
    since_speed_m: 2.5,
    energy_per_slip: 4.0,
    altitude: Reading::NONE,
    altitude_behind_m: 0.0,
    slope: Reading::NONE,
    rest_percent: 0.0,
    marks: Marks {
        invalid: false,
        slope_is_read: false,
        by_accelerometer: false,
        overrun: false,
        rest_begins: false,
        load_told: false,
        gap: false,
        receiver_switched: false,
        crawling: false,
    },
};

/// The first cell of a drive.
pub fn first() -> CellInput {
    CellInput {
        marks: Marks {
            gap: true,
            ..Marks::default()
        },
        altitude: fix(0.0),
        ..LEVEL
    }
}

/// A fix at the end of a cell.
pub const fn fix(altitude_m: f32) -> Reading {
    Reading {
        value: altitude_m,
        variance: 0.09,
    }
}

/// Any ordinary cell.
pub fn any_cell() -> impl Strategy<Value = CellInput> {
    let forces = (
        -0.5f32..0.5,
        -4.0f32..8.0,
        -2.0f32..2.0,
        0.0f32..4.0,
        -1.0f32..1.0,
    );
    let readings = (196.0f32..204.0, -0.5f32..0.5, any::<bool>(), any::<bool>());
    let marks = (any::<bool>(), any::<bool>(), 0u8..12);
    (forces, readings, marks).prop_map(|(forces, readings, marks)| {
        let (work, net, jump, retarder, retarder_step) = forces;
        let (energy, altitude, has_energy, has_altitude) = readings;
        let (invalid, may_load, rare) = marks;
        let or_none = |is_some: bool, reading| if is_some { reading } else { Reading::NONE };
        CellInput {
            work,
            net_traction_percent: net,
            traction_jump_percent: if rare < 3 { jump } else { 0.0 },
            retarder_percent: if rare < 6 { retarder } else { 0.0 },
            retarder_step_percent: if rare < 6 { retarder_step } else { 0.0 },
            load_variance: if may_load && rare == 0 { 0.6 } else { 0.0 },
            energy: or_none(
                has_energy,
                Reading {
                    value: energy,
                    ..LEVEL.energy
                },
            ),
            altitude: or_none(has_altitude, fix(altitude)),
            marks: Marks {
                invalid,
                ..Marks::default()
            },
            ..LEVEL
        }
    })
}
