//! Samples.

use estimator_core::sample::{
    AltitudeContinuity, AltitudeMeasurement, EffectInputs, ForceInputs, Sample, SpeedMeasurement,
};
use estimator_core::{CELL_LENGTH_M, CellEnd, Condition, Disagreement, Instant};

/// Returns a sample at cell `cell` with nothing measured.
pub fn sample(cell: u32, traction_n: f32, speed_mps: f32) -> Sample {
    let duration_s = CELL_LENGTH_M / speed_mps;
    Sample {
        end: CellEnd {
            cell,
            time: Instant::from_micros((f64::from(cell) * f64::from(duration_s) * 1e6) as u64),
            position_e7: None,
            speed_mps,
            condition: Condition::default(),
        },
        gap_cells: 0,
        length_m: CELL_LENGTH_M,
        duration_s,
        forces: ForceInputs {
            traction_n,
            rotating_kg: 500.0,
            mass_kg: 39_000.0,
            air_density: 1.2,
        },
        effect_inputs: EffectInputs::default(),
        speed: None,
        altitude: None,
        inertial: None,
        slope: None,
        after_load_change: false,
        after_stop: false,
        mass_is_reported: false,
        torque_rest: Default::default(),
        retarder_n: 0.0,
        service_braking: false,
        traction_late_s: 0.0,
        disagreement: Disagreement::default(),
        disagreeing_cells: 0,
    }
}

/// Returns a speed measured at the cell's end.
pub fn speed(mean_mps: f32) -> Option<SpeedMeasurement> {
    Some(SpeedMeasurement {
        mean_mps,
        behind_m: 0.0,
        count: 1,
        resolution_mps: 0.0,
    })
}

/// Returns an altitude measured at the cell's end.
pub fn altitude(altitude_m: f32) -> Option<AltitudeMeasurement> {
    Some(AltitudeMeasurement {
        altitude_m,
        behind_m: 0.0,
        dilution: 1.0,
        continuity: AltitudeContinuity::Followed,
    })
}
