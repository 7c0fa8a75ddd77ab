//! Altitudes that a receiver gives late: the delay is found, and carried over.

use estimator_core::filter::ModelMass;
use estimator_core::sample::Sample;
use estimator_core::{CELL_LENGTH_M, Counters, Tuning};
use test_kit::{FilterRun, Noise, altitude, sample, speed, truck};

const SPEED_MPS: f32 = 20.0;
/// Cells of a second.
const SECOND: u32 = 8;

/// Returns the altitude at a cell of a hilly road, m: 4 % at most.
fn road_m(cell: f32) -> f32 {
    100.0 + 12.0 * (cell * CELL_LENGTH_M / 300.0).sin()
}

/// Drives hills with altitudes that are so late, with samples that `change` changes. Returns the
/// errors of the altitude, m, and the counters.
fn driven(cells: u32, late_s: u32, change: impl Fn(u32, &mut Sample)) -> (Vec<f32>, Counters) {
    let vehicle = truck();
    let weight_n = vehicle.mass_kg * 9.806_65;
    let air_n = 0.5 * vehicle.drag_area_m2 * 1.2 * SPEED_MPS * SPEED_MPS;
    let mut run = FilterRun::<f64>::new(vehicle.clone(), Tuning::default());
    let mut noise = Noise(9);
    let errors = (1..=cells).map(|cell| {
        let sine = (road_m(cell as f32) - road_m(cell as f32 - 1.0)) / CELL_LENGTH_M;
        let force_n = air_n + weight_n * (vehicle.rolling_resistance + sine);
        let mut sample = sample(cell, force_n, SPEED_MPS);
        sample.mass_is_reported = true;
        sample.speed = speed(SPEED_MPS + 0.01 * noise.draw());
        if cell % SECOND == 0 {
            let then = cell.saturating_sub(SECOND * late_s);
            sample.altitude = altitude(road_m(then as f32) + 0.2 * noise.draw());
        }
        change(cell, &mut sample);
        let step = run.step(&sample).expect("a speed");
        let found = step.state.estimate(&ModelMass::default()).altitude_m;
        found.map_or(0.0, |found| found.value - road_m(cell as f32))
    });
    let errors = errors.collect();
    (errors, run.context.counters)
}

fn rms(errors: &[f32]) -> f32 {
    (errors.iter().map(|error| error * error).sum::<f32>() / errors.len() as f32).sqrt()
}

#[test]
fn a_delay_is_found_and_the_altitude_is_carried_over_it() {
    for late_s in [0, 9] {
        let (errors, counters) = driven(16_000, late_s, |_, _| ());
        // Without it the altitudes are off by 6 m.
        let worst_m = rms(&errors[14_000..]);
        assert!(worst_m < 2.0, "{late_s} s late: {worst_m} m");
        // Once at the start, and once when the delay is known.
        let expected = if late_s == 0 { 1 } else { 2 };
        assert_eq!(counters.altitude_resets, expected, "{late_s} s late");
    }
}

#[test]
fn after_a_stop_late_altitudes_wait_until_two_show_how_fast_they_change() {
    let stop = 15_000;
    let used = |until: u32| {
        let (errors, counters) = driven(until, 9, |cell, sample| {
            if cell == stop {
                sample.duration_s = 20.0;
            }
        });
        (rms(&errors[until as usize - 8..]), counters.altitudes_used)
    };
    let (_, before) = used(stop);
    // Fixes come every second, and the rate is that over two.
    let (_, waiting) = used(stop + 2 * SECOND);
    let (off_m, after) = used(stop + 20 * SECOND);
    assert_eq!(waiting, before);
    assert!((16..=18).contains(&(after - before)), "{before} {after}");
    assert!(off_m < 3.0, "{off_m}");
}
