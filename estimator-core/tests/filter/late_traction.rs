//! A force that is late beside the motion.

use estimator_core::Tuning;
use estimator_core::filter::ModelMass;
use estimator_core::sample::Sample;
use test_kit::{Noise, altitude, run_counted, sample, smooth, speed};

const LATE_S: f32 = 2.0;
const SPEED_MPS: f32 = 20.0;

/// Returns the slope at a distance, %: hills of 2 %, 1,200 m long.
fn slope_percent(distance_m: f32) -> f32 {
    2.0 * (distance_m / 1_200.0 * core::f32::consts::TAU).sin()
}

/// Returns the sample of a cell at a steady speed, without an altitude, with the force that the slope
/// took so long ago.
fn late_sample(cell: u16, late_s: f32) -> Sample {
    let middle_m = 2.5 * f32::from(cell) - 1.25;
    let reported = slope_percent(middle_m - SPEED_MPS * late_s);
    let force_n = 3_926.0 + 39_000.0 * 9.806_65 * 0.01 * reported;
    let mut sample = sample(cell.into(), force_n, SPEED_MPS);
    sample.speed = speed(SPEED_MPS);
    sample
}

/// A drive of 10 km.
fn drive(stated_late_s: f32) -> Vec<Sample> {
    let mut altitude_m = 100.0;
    (1..=4_000_u16)
        .map(|cell| {
            altitude_m += 0.025 * slope_percent(2.5 * f32::from(cell) - 1.25);
            let mut sample = late_sample(cell, LATE_S);
            sample.traction_late_s = stated_late_s;
            if cell % 8 == 0 {
                sample.altitude = altitude(altitude_m);
            }
            sample
        })
        .collect()
}

/// Returns the error of the live slope over the last 10 of 60 km, %. Altitudes have noise. The force
/// of each cell is as late as `late_s` says, and nothing states it.
fn live_error_percent(late_s: impl Fn(u16) -> f32) -> f32 {
    let mut noise = Noise(7);
    let mut altitude_m = 100.0;
    let samples: Vec<Sample> = (1..=24_000_u16)
        .map(|cell| {
            altitude_m += 0.025 * slope_percent(2.5 * f32::from(cell) - 1.25);
            let mut sample = late_sample(cell, late_s(cell));
            if cell % 8 == 0 {
                sample.altitude = altitude(altitude_m + 0.3 * noise.draw());
            }
            sample
        })
        .collect();
    let (cells, _) = run_counted::<f32>(&samples, &Tuning::default());
    let last = &cells[20_000..];
    let squares: f32 = last
        .iter()
        .zip(20_001_u16..)
        .map(|(cell, number)| {
            let live_percent = cell
                .state
                .estimate(&ModelMass::default())
                .grade_percent
                .value;
            (live_percent - slope_percent(2.5 * f32::from(number))).powi(2)
        })
        .sum();
    (squares / last.len() as f32).sqrt()
}

#[test]
fn altitudes_show_a_late_force_where_no_shift_does() {
    let in_time = live_error_percent(|_| 0.0);
    let late = live_error_percent(|_| LATE_S);
    let lately = live_error_percent(|cell| if cell < 20_000 { 0.0 } else { LATE_S });
    assert!(
        late < 0.7 * lately,
        "{late} %, {lately} % before it shows, {in_time} % in time"
    );
    let no_longer = live_error_percent(|cell| if cell < 8_000 { LATE_S } else { 0.0 });
    assert!(
        no_longer < 1.1 * in_time,
        "{no_longer} %, {in_time} % in time"
    );
}

#[test]
fn what_would_be_later_than_torque_that_is_used_is_no_lag() {
    let five_s = live_error_percent(|_| 5.0);
    let lately = live_error_percent(|cell| if cell < 20_000 { 0.0 } else { 5.0 });
    // To correct it would make the error larger.
    assert!(
        (0.8 * lately..1.1 * lately).contains(&five_s),
        "{five_s} %, {lately} % before it shows"
    );
}

/// Returns the error of the smoothed slope, %, and the mean of its square over its variance.
fn judged(stated_late_s: f32) -> (f32, f32) {
    let (cells, _) = run_counted::<f64>(&drive(stated_late_s), &Tuning::default());
    let smoothed = smooth(&cells);
    let (mut squares, mut normalised) = (0.0, 0.0);
    for (k, estimate) in smoothed.iter().enumerate() {
        let error = estimate.grade_percent.value - slope_percent(2.5 * (k as f32 + 1.0));
        squares += error * error;
        normalised += (error / estimate.grade_percent.sigma).powi(2);
    }
    let count = smoothed.len() as f32;
    ((squares / count).sqrt(), normalised / count)
}

#[test]
fn what_a_late_force_lacks_is_added() {
    let (unstated, lies) = judged(0.0);
    let (stated, honest) = judged(LATE_S);
    assert!(lies > 9.0, "{lies}");
    assert!(stated < 0.5 * unstated, "{stated} % of {unstated} %");
    assert!(honest < 4.0, "{honest}");
}

#[test]
fn where_the_model_does_not_hold_nothing_is_added() {
    let mut samples = drive(LATE_S);
    for sample in &mut samples {
        sample.end.condition.no_traction = true;
    }
    let mut unstated = samples.clone();
    for sample in &mut unstated {
        sample.traction_late_s = 0.0;
    }
    let tuning = Tuning::default();
    let slopes = |samples: &[Sample]| {
        let (cells, _) = run_counted::<f64>(samples, &tuning);
        smooth(&cells)
            .iter()
            .map(|estimate| estimate.grade_percent.value)
            .collect::<Vec<_>>()
    };
    assert_eq!(slopes(&samples), slopes(&unstated));
}
