//! Unreported brakes, and errors of the receiver that are not brakes.

use estimator_core::Tuning;
use estimator_core::sample::Sample;
use test_kit::{FilterRun, Noise, altitude, sample, speed, truck};

const SPEED_MPS: f32 = 20.0;

/// Rolls 10 km down a road at a steady speed, without traction. From cell 2,000 on, a brake holds a
/// road that is steeper by `hidden_percent`, and altitudes are wrong by `wrong_m`. Returns the cells
/// in which a brake is found.
fn found_brakes(hidden_percent: f32, wrong_m: impl Fn(u32) -> f32) -> Vec<u32> {
    let vehicle = truck();
    let weight_n = vehicle.mass_kg * 9.806_65;
    let air_n = 0.5 * vehicle.drag_area_m2 * 1.2 * SPEED_MPS * SPEED_MPS;
    let rolls = -(air_n / weight_n + vehicle.rolling_resistance);
    let mut run = FilterRun::<f64>::new(vehicle, Tuning::default());
    let mut noise = Noise(5);
    let mut true_m = 500.0;
    let steps = (1..=4_000_u32).filter(|&cell| {
        let hidden = if cell >= 2_000 {
            0.01 * hidden_percent
        } else {
            0.0
        };
        true_m += 2.5 * (rolls - hidden);
        let mut sample: Sample = sample(cell, 0.0, SPEED_MPS);
        sample.mass_is_reported = true;
        sample.speed = speed(SPEED_MPS + 0.013 * noise.draw());
        if cell % 8 == 0 {
            sample.altitude = altitude(true_m + wrong_m(cell) + 0.3 * noise.draw());
        }
        let step = run.step(&sample).expect("a speed");
        step.record.disagreement.brake
    });
    steps.collect()
}

#[test]
fn a_descent_that_a_brake_hides_is_found_within_300_m() {
    for hidden_percent in [3.0, 5.0, 8.0] {
        let found = found_brakes(hidden_percent, |_| 0.0);
        let first = *found.first().expect("a brake");
        assert!(
            (2_000..2_120).contains(&first),
            "{hidden_percent} %: {first}"
        );
    }
}

#[test]
fn a_step_of_the_receiver_is_no_brake() {
    for step_m in [-6.0, -8.0, -15.0] {
        for cells in [60, 200, 2_000] {
            let wrong_m = |cell| {
                if (2_000..2_000 + cells).contains(&cell) {
                    step_m
                } else {
                    0.0
                }
            };
            let found = found_brakes(0.0, wrong_m);
            assert!(found.is_empty(), "{step_m} m, {cells} cells: {found:?}");
        }
    }
}
