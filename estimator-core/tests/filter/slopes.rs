//! Slopes that a sensor measures directly, on a hilly road at a steady speed.

use crate::batch::batch;
use estimator_core::filter::Quantity;
use estimator_core::filter::measurement::Observation;
use estimator_core::sample::{Sample, SlopeMeasurement, SlopeSensor};
use estimator_core::{CELL_LENGTH_M, Counters, Scalar, Tuning};
use proptest::prelude::*;
use test_kit::{
    FilterRun, FilteredStep, Noise, altitude, run_counted, sample, smooth, speed, truck,
};

const GRAVITY: f32 = 9.806_65;
const SPEED_MPS: f32 = 20.0;
/// Cells in a second.
const SECOND: u32 = 8;

/// Returns the slope at the end of a cell, sine in %.
fn slope_percent(cell: u32) -> f32 {
    2.0 * (cell as f32 * CELL_LENGTH_M / 300.0).sin()
}

/// Returns a drive whose force has an error that the model reads as `bias_percent` of slope, and a
/// sensor of `every` nth cell that reads what `reading` makes of the true slope and the cell.
fn drive(
    cells: u32,
    bias_percent: f32,
    (sensor, every): (SlopeSensor, u32),
    reading: impl Fn(f32, u32) -> f32,
) -> Vec<Sample> {
    let vehicle = truck();
    let mut noise = Noise(1);
    let mut altitude_m = 100.0;
    (1..=cells)
        .map(|cell| {
            let mean_percent = 0.5 * (slope_percent(cell) + slope_percent(cell - 1));
            altitude_m += 0.01 * mean_percent * CELL_LENGTH_M;
            let air_n = 0.5 * vehicle.drag_area_m2 * 1.2 * SPEED_MPS * SPEED_MPS;
            let slope_mps2 = 0.01 * GRAVITY * (mean_percent + bias_percent);
            let force_n =
                air_n + vehicle.mass_kg * (vehicle.rolling_resistance * GRAVITY + slope_mps2);
            let mut sample = sample(cell, force_n + 50.0 * noise.draw(), SPEED_MPS);
            sample.mass_is_reported = true;
            sample.speed = speed(SPEED_MPS + 0.005 * noise.draw());
            if cell == 1 {
                sample.altitude = altitude(altitude_m);
            }
            if cell % every == 0 {
                sample.slope = Some(SlopeMeasurement {
                    slope_percent: reading(slope_percent(cell), cell),
                    sensor,
                });
            }
            sample
        })
        .collect()
}

/// Returns the root mean square error of the live slope from a cell on, %, and the counters.
fn live_error(samples: &[Sample], from: usize) -> (f32, Counters) {
    let mut run = FilterRun::<f32>::new(truck(), Tuning::default());
    let errors: Vec<f32> = samples
        .iter()
        .map(|sample| {
            let step = run.step(sample).expect("every sample has a speed");
            let slope = step.state.quantity(Quantity::Slope).mean.to_f32();
            slope - slope_percent(sample.end.cell)
        })
        .skip(from)
        .collect();
    let squares: f32 = errors.iter().map(|error| error * error).sum();
    let rmse = (squares / errors.len() as f32).sqrt();
    (rmse, run.context.counters)
}

const VERTICAL: (SlopeSensor, u32) = (SlopeSensor::VerticalSpeed, SECOND);
const PITCH: (SlopeSensor, u32) = (SlopeSensor::Pitch, 1);

/// Adds the noise of a vertical speed of 0.05 m/s.
fn noisy(slope: f32, cell: u32) -> f32 {
    slope + 0.25 * Noise(u64::from(cell) * 7919 + 1).draw()
}

#[test]
fn a_vertical_speed_shows_the_bias_of_the_model() {
    let blind = drive(6_000, 0.2, (SlopeSensor::VerticalSpeed, u32::MAX), noisy);
    let seeing = drive(6_000, 0.2, VERTICAL, noisy);
    let (without, _) = live_error(&blind, 4_000);
    let (with, counters) = live_error(&seeing, 4_000);
    assert!(without > 0.15, "{without}");
    assert!(with < 0.5 * without, "{with} of {without}");
    assert!(counters.slopes_used > 600);
    assert!(counters.slopes_rejected < 10);
}

#[test]
fn a_sensor_of_another_sign_or_unit_or_a_stuck_one_changes_nothing() {
    let blind = drive(6_000, 0.0, (SlopeSensor::VerticalSpeed, u32::MAX), noisy);
    let (without, _) = live_error(&blind, 0);
    let wrong: [fn(f32, u32) -> f32; 4] = [
        |slope, cell| -noisy(slope, cell),
        |slope, cell| 3.6 * noisy(slope, cell),
        |slope, cell| 0.01 * noisy(slope, cell),
        |_, _| 0.7,
    ];
    for sensor in [VERTICAL, PITCH] {
        for reading in wrong {
            let (with, counters) = live_error(&drive(6_000, 0.0, sensor, reading), 0);
            assert_eq!(with, without);
            assert_eq!(counters.slopes_used, 0);
            assert!(counters.slopes_rejected > 500);
        }
    }
}

#[test]
fn a_stray_reading_is_left_out() {
    let stray = |slope: f32, cell: u32| {
        if cell == 4_800 {
            slope + 20.0
        } else {
            noisy(slope, cell)
        }
    };
    let (right, before) = live_error(&drive(6_000, 0.0, VERTICAL, noisy), 4_790);
    let (with, after) = live_error(&drive(6_000, 0.0, VERTICAL, stray), 4_790);
    assert_eq!(after.slopes_rejected, before.slopes_rejected + 1);
    assert!(with < 1.1 * right);
}

/// Lets the torque be missing from a cell on.
fn without_torque(mut samples: Vec<Sample>, from: u32) -> Vec<Sample> {
    for sample in samples.iter_mut().filter(|of| of.end.cell >= from) {
        sample.end.condition.no_traction = true;
    }
    samples
}

#[test]
fn a_pitch_stands_in_for_a_missing_torque_and_only_there() {
    let tilted = |slope: f32, cell: u32| 1.05 * slope + 1.5 + 0.4 * (noisy(slope, cell) - slope);
    let blind = drive(6_000, 0.0, (SlopeSensor::Pitch, u32::MAX), tilted);
    let seeing = drive(6_000, 0.0, PITCH, tilted);
    let (without, _) = live_error(&blind, 0);
    let (with, counters) = live_error(&seeing, 0);
    assert_eq!((with, counters.slopes_used), (without, 0));
    let (without, _) = live_error(&without_torque(blind, 5_600), 5_600);
    let (with, counters) = live_error(&without_torque(seeing, 5_600), 5_600);
    assert!(without > 1.0, "{without}");
    assert!(with < 0.2, "{with}");
    assert!(counters.slopes_used > 100);
}

#[test]
fn a_flat_road_does_not_show_what_a_sensor_reads() {
    let mut samples = drive(6_000, 0.0, VERTICAL, |_, cell| noisy(0.0, cell));
    let level_n = samples[0].forces.traction_n;
    for sample in &mut samples {
        sample.forces.traction_n = level_n;
    }
    let mut run = FilterRun::<f32>::new(truck(), Tuning::default());
    samples.iter().for_each(|sample| {
        run.step(sample);
    });
    let counters = run.context.counters;
    assert_eq!((counters.slopes_used, counters.slopes_rejected), (0, 0));
}

#[test]
fn another_load_may_tilt_the_body() {
    let tilted = |after_percent: f32| {
        move |slope: f32, cell: u32| {
            let offset = if cell < 3_000 { 1.0 } else { after_percent };
            offset + slope + 0.4 * (noisy(slope, cell) - slope)
        }
    };
    let stopping = |after_percent| {
        let mut samples = drive(3_600, 0.0, PITCH, tilted(after_percent));
        samples[2_999].after_load_change = true;
        let (rmse, counters) = live_error(&without_torque(samples, 3_200), 3_200);
        assert!(counters.slopes_used > 100, "{}", counters.slopes_used);
        rmse
    };
    let [same, another] = [1.0, 1.5].map(stopping);
    assert!(another < 1.5 * same + 0.1, "{another} {same}");
}

#[test]
fn altitudes_in_each_cell_do_not_keep_a_slope_waiting() {
    let mut samples = drive(6_000, 0.0, VERTICAL, noisy);
    for sample in &mut samples {
        sample.altitude = altitude(100.0);
    }
    let (_, counters) = live_error(&samples, 0);
    assert!(counters.slopes_used > 100);
}

/// Returns the last steps of a drive in a number type.
fn last_steps<S: Scalar>(samples: &[Sample], from: usize) -> Vec<FilteredStep<S>> {
    run_counted::<S>(samples, &Tuning::default())
        .0
        .split_off(from)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(8))]

    #[test]
    fn smoothing_over_measured_slopes_equals_the_batch_solution(
        errors in prop::collection::vec(-0.15..0.15_f32, 60),
        is_pitch: bool,
    ) {
        let known = 1_600;
        let error = |cell: u32| errors.get(cell.saturating_sub(known) as usize).unwrap_or(&0.0);
        let sensor = if is_pitch { PITCH } else { VERTICAL };
        let mut samples = drive(known + 50, 0.1, sensor, |slope, cell| slope + error(cell));
        if is_pitch {
            samples = without_torque(samples, known + 10);
        }
        let from = known as usize;
        let cells = last_steps::<f64>(&samples, from);
        let used = cells.iter().filter(|cell| {
            let second = cell.record.smoother_input.second;
            second.is_some_and(|(observation, _)| {
                matches!(observation, Observation::RoadSlope | Observation::ModelSlope)
            })
        });
        prop_assert!(used.count() > 4);
        let reference = batch(&samples[from..], &cells, &Tuning::default());
        for (smoothed, (slope, sigma)) in smooth(&cells).iter().zip(&reference) {
            let found = smoothed.grade_percent;
            prop_assert!((f64::from(found.value) - slope).abs() < 1e-3, "{} {slope}", found.value);
            // The core computes its coefficients in single precision.
            prop_assert!((f64::from(found.sigma) / sigma - 1.0).abs() < 1e-2);
        }
    }
}
