//! Our estimator on a drive of the thesis's kind: the filter of the vehicle with its default
//! tuning, on the inputs of the other methods.

use crate::comparison::{MeasuredDrive, MeasuredPoint, Profile, STEP_M};
use crate::smooth::{Known, smooth_run};
use estimator_core::estimator::CellEstimator;
use estimator_core::sample::{
    AltitudeContinuity, AltitudeMeasurement, EffectInputs, ForceInputs, Sample, SpeedMeasurement,
};
use estimator_core::{
    Cell, CellEnd, Condition, Context, Counters, Disagreement, Instant, Model, Traction, Tuning,
    Uncertain, VehicleParameters,
};
use std::iter::from_fn;

/// Time between two fixes of a receiver, s.
const FIX_INTERVAL_S: f64 = 1.0;

/// Our estimator on one drive.
#[derive(Clone, Debug)]
pub struct Ours {
    /// Smoothed grade.
    pub smoothed: Profile,
    /// Lagged grade.
    pub lagged: Profile,
    /// Live grade.
    pub live: Profile,
    /// Readings that the filter used and rejected on the vehicle.
    pub counters: Counters,
}

/// Runs the estimator on a drive: in single precision as on the vehicle, in double after it.
#[must_use]
pub fn estimate(drive: &MeasuredDrive) -> Ours {
    let mut context = context(drive);
    let samples = samples(drive);
    let mut estimator = CellEstimator::<f32>::new();
    let mut cells: Vec<Cell> = Vec::with_capacity(samples.len());
    for sample in &samples {
        estimator.push_and_work(&mut context, sample);
        cells.extend(from_fn(|| estimator.next_cell(&mut context)));
    }
    cells.extend(from_fn(|| estimator.drain_cell(&mut context)));
    let smoothed = smooth_run(&context, Known::default(), &samples);
    Ours {
        smoothed: profile(smoothed.iter().map(|cell| cell.estimate.grade_percent)),
        lagged: profile(cells.iter().map(|cell| cell.lagged_grade_percent)),
        live: profile(cells.iter().map(|cell| cell.live_grade_percent)),
        counters: context.counters,
    }
}

/// Returns the context of a drive before its first sample.
#[must_use]
pub fn context(drive: &MeasuredDrive) -> Context {
    Context {
        model: Model::from(assumed_vehicle(drive)),
        tuning: Tuning::default(),
        counters: Counters::default(),
    }
}

/// Returns the vehicle with the drive's assumed parameters. Traction force and rotating mass come
/// with each point, so the wheel radius does not matter.
fn assumed_vehicle(drive: &MeasuredDrive) -> VehicleParameters {
    VehicleParameters {
        mass_kg: drive.mass_kg as f32,
        drag_area_m2: drive.drag_area_m2 as f32,
        rolling_resistance: drive.rolling_resistance as f32,
        wheel_radius_m: 0.5,
        wheel_inertia_kgm2: 0.0,
        traction: Traction::Force,
    }
}

/// Returns one sample a point, which ends the cell before it. Speed and altitude are those of the
/// point; force and condition are those of the step before it. The drive has altitude at each
/// point; a receiver reports it once a second.
#[must_use]
pub fn samples(drive: &MeasuredDrive) -> Vec<Sample> {
    let points = &drive.points;
    let mut elapsed_s = 0.0;
    let mut next_fix_s = 0.0;
    let mut samples = Vec::with_capacity(points.len());
    for (k, point) in points.iter().enumerate() {
        let before = &points[k.saturating_sub(1)];
        let duration_s = 2.0 * STEP_M / (before.speed_mps + point.speed_mps);
        elapsed_s += duration_s;
        let mut altitude = None;
        if elapsed_s >= next_fix_s {
            next_fix_s += FIX_INTERVAL_S;
            altitude = point.altitude_m.map(altitude_measurement);
        }
        samples.push(Sample {
            end: CellEnd {
                cell: k as u32,
                time: Instant::from_micros((elapsed_s * 1e6) as u64),
                position_e7: None,
                speed_mps: point.speed_mps as f32,
                condition: condition(before),
            },
            gap_cells: 0,
            length_m: STEP_M as f32,
            duration_s: duration_s as f32,
            forces: ForceInputs {
                traction_n: before.traction_n as f32,
                rotating_kg: before.rotating_kg as f32,
                mass_kg: drive.mass_kg as f32,
                air_density: before.air_density as f32,
            },
            // Inputs of effects: the vehicle has none.
            effect_inputs: EffectInputs::default(),
            speed: Some(SpeedMeasurement {
                mean_mps: point.speed_mps as f32,
                behind_m: 0.0,
                count: 1,
                resolution_mps: 0.0,
            }),
            altitude,
            inertial: None,
            slope: None,
            after_load_change: false,
            after_stop: false,
            // The thesis takes the mass that the vehicle knows.
            mass_is_reported: true,
            torque_rest: Default::default(),
            retarder_n: 0.0,
            service_braking: before.braking,
            traction_late_s: 0.0,
            disagreement: Disagreement::default(),
            disagreeing_cells: 0,
        });
    }
    samples
}

fn altitude_measurement(altitude_m: f64) -> AltitudeMeasurement {
    AltitudeMeasurement {
        altitude_m: altitude_m as f32,
        behind_m: 0.0,
        dilution: 1.0,
        continuity: AltitudeContinuity::Followed,
    }
}

fn condition(point: &MeasuredPoint) -> Condition {
    Condition {
        shifting: point.shifting,
        braking: point.braking,
        ..Condition::default()
    }
}

fn profile(grades: impl IntoIterator<Item = Uncertain>) -> Profile {
    let (grade_percent, sigma_percent) = grades
        .into_iter()
        .map(|grade| (f64::from(grade.value), f64::from(grade.sigma)))
        .unzip();
    Profile {
        grade_percent,
        sigma_percent,
    }
}
