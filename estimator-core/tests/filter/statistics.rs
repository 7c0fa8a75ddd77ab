//! Statistics of the filter: white innovations, and a result that does not depend on the length of
//! its steps.

use estimator_core::filter::measurement::ScalarUpdate;
use estimator_core::filter::{ModelMass, STATES};
use estimator_core::sample::Sample;
use estimator_core::{CELL_LENGTH_M, Tuning};
use nalgebra::DVector;
use test_kit::dense::{
    ALTITUDE, BIAS, ENERGY, GNSS_ERROR, LearnedByThen, Motion, SCALE, SLOPE, dense_model,
    net_tractions,
};
use test_kit::{FilterRun, Noise, altitude, run, sample, speed, truck};

/// Returns a drive drawn from the model of the filter.
fn drawn(cells: u32, seed: u64, tuning: &Tuning) -> Vec<Sample> {
    let vehicle = truck();
    let noise_of = &tuning.measurement_noise;
    let mut noise = Noise(seed);
    let mut normal = || f64::from(noise.draw());
    let weight_n = f64::from(vehicle.mass_kg) * 9.806_65;
    let mut x = DVector::zeros(STATES);
    x[ENERGY] = 0.5 * 22.0 * 22.0;
    x[SCALE] = f64::from(tuning.prior.scale_sigma) * normal();
    x[BIAS] = 0.2 * normal();
    x[GNSS_ERROR] = f64::from(noise_of.gnss_error_sigma_m) * normal();
    let mut samples: Vec<Sample> = Vec::new();
    for k in 1..=cells {
        let mps = (2.0_f64 * x[ENERGY]).sqrt();
        // A driver who keeps to 22 m/s, on a road that returns to level.
        let air_n = 0.5 * 6.0 * 1.2 * mps * mps;
        let force_n =
            air_n + weight_n * (0.006_5 + 0.01 * x[SLOPE]) + 39_000.0 * 0.2 * (22.0 - mps);
        let mut s = sample(k, force_n as f32, mps as f32);
        if let Some(before) = samples.last() {
            let moved = |net_traction| Motion {
                net_traction,
                launches: false,
            };
            let net_tractions = net_tractions(&[*before, s]);
            let motions = (moved(net_tractions[0]), moved(net_tractions[1]));
            let known = LearnedByThen {
                force_ratio: 1.0,
                scale: 1.0 + x[SCALE],
                scale_sigma: 0.0,
            };
            let (f, input, q) = dense_model(&s, motions, known, tuning);
            let process_noise = q.map(|variance: f64| variance.sqrt() * normal());
            x = f * x + input + process_noise;
            x[SLOPE] *= 0.999;
        }
        let mps = (2.0_f64 * x[ENERGY]).sqrt() + f64::from(noise_of.speed_sigma_mps) * normal();
        s.speed = speed(mps as f32);
        if k % 9 == 1 {
            let white = f64::from(noise_of.altitude_sigma_m) * normal();
            s.altitude = altitude((x[ALTITUDE] + x[GNSS_ERROR] + white) as f32);
        }
        samples.push(s);
    }
    samples
}

/// Returns the mean square of a normalised series, and its autocorrelation at a lag.
fn whiteness(series: &[f64], lag: usize) -> (f64, f64) {
    let power: f64 = series.iter().map(|e| e * e).sum();
    let shifted = series.iter().zip(&series[lag..]);
    let product: f64 = shifted.map(|(a, b)| a * b).sum();
    (power / series.len() as f64, product / power)
}

#[test]
fn innovations_are_white_and_of_the_stated_variance() {
    let tuning = Tuning::default();
    let samples = drawn(40_000, 11, &tuning);
    let cells = run::<f64>(&samples, &tuning);
    let normalised =
        |update: &ScalarUpdate<f64>| update.innovation / update.innovation_variance.sqrt();
    let inputs: Vec<_> = cells[2_000..]
        .iter()
        .map(|cell| cell.record.smoother_input)
        .collect();
    let speeds: Vec<f64> = inputs
        .iter()
        .filter_map(|input| input.speed.as_ref().map(normalised))
        .collect();
    let altitudes: Vec<f64> = inputs
        .iter()
        .filter_map(|input| input.altitude().map(normalised))
        .collect();
    assert!(speeds.len() == 38_000 && altitudes.len() > 4_000);
    for (name, series) in [("speed", speeds), ("altitude", altitudes)] {
        // Four standard errors of a white series' autocorrelation.
        let limit = 4.0 / (series.len() as f64).sqrt();
        for lag in [1, 2, 3, 5, 10, 30] {
            let (power, correlation) = whiteness(&series, lag);
            assert!((0.9..1.1).contains(&power), "{name}: {power}");
            assert!(
                correlation.abs() < limit,
                "{name}, lag {lag}: {correlation}"
            );
        }
    }
}

/// Returns a drive over hills in steps of this length, m, with readings every 2.5 m.
fn hills(step_m: f32) -> Vec<Sample> {
    let vehicle = truck();
    let weight_n = vehicle.mass_kg * 9.806_65;
    let per_cell = (CELL_LENGTH_M / step_m).round() as u32;
    let slope = |at_m: f64| 2.5 * (at_m / 250.0).sin() + 0.8 * (at_m / 90.0).cos();
    let height = |at_m: f64| -6.25 * (at_m / 250.0).cos() + 0.72 * (at_m / 90.0).sin();
    let (mut reading, mut fix) = (Noise(3), Noise(4));
    let mut energy = 0.5 * 22.0_f64 * 22.0;
    (1..=4_000 * per_cell)
        .map(|k| {
            let at_m = f64::from(k) * f64::from(step_m);
            let middle = at_m - 0.5 * f64::from(step_m);
            let air_n = 6.0 * 1.2 * energy;
            // The engine compensates most of the hill, and the speed changes by the rest.
            let force_n = air_n
                + f64::from(weight_n) * (0.006_5 + 0.008 * slope(middle))
                + 39_000.0 * 0.05 * (22.0 - (2.0 * energy).sqrt());
            let net_n = force_n - air_n - f64::from(weight_n) * (0.006_5 + 0.01 * slope(middle));
            energy += net_n / 39_500.0 * f64::from(step_m);
            let mps = (2.0 * energy).sqrt();
            let mut s = sample(k, force_n as f32, mps as f32);
            s.length_m = step_m;
            s.duration_s = step_m / mps as f32;
            s.end.cell = k / per_cell;
            if k % per_cell == 0 {
                s.speed = speed(mps as f32 + 0.011 * reading.draw());
                if s.end.cell % 9 == 1 {
                    s.altitude = altitude(height(at_m) as f32 + 0.5 * fix.draw());
                }
            }
            s
        })
        .collect()
}

#[test]
fn halving_the_step_changes_almost_nothing() {
    let tuning = Tuning::default();
    let grades = |step_m: f32| -> Vec<f32> {
        let mut samples = hills(step_m);
        // The first step starts from a speed, for any length.
        samples[0].speed = speed(22.0);
        let cells = run::<f64>(&samples, &tuning);
        let per_cell = (CELL_LENGTH_M / step_m).round() as usize;
        cells
            .iter()
            .skip(per_cell - 1)
            .step_by(per_cell)
            .map(|cell| {
                cell.state
                    .estimate(&ModelMass::default())
                    .grade_percent
                    .value
            })
            .collect()
    };
    let (whole, half) = (grades(2.5), grades(1.25));
    assert_eq!(whole.len(), half.len());
    let squares: f64 = whole
        .iter()
        .zip(&half)
        .skip(200)
        .map(|(a, b)| f64::from(a - b).powi(2))
        .sum();
    let rms = (squares / (whole.len() - 200) as f64).sqrt();
    assert!(rms < 0.01, "{rms} % grade");
    // The grades that are compared are not zero.
    let spread = whole
        .iter()
        .fold(0.0_f32, |most, grade| most.max(grade.abs()));
    assert!(spread > 2.0, "{spread}");
}

#[test]
fn what_crawls_shows_nothing_of_the_noise_of_the_speed() {
    let ratio = |crawling: bool| {
        let mut run = FilterRun::<f64>::new(truck(), Tuning::default());
        let mut noise = Noise(4);
        for cell in 1..=2_000 {
            let is_noisy = cell > 1_000;
            let mut sample = sample(cell, 3_926.0, 20.0);
            sample.speed = speed(20.0 + if is_noisy { 0.2 } else { 0.013 } * noise.draw());
            sample.end.condition.crawling = is_noisy && crawling;
            run.step(&sample).expect("a speed");
        }
        run.filter.noise().speed
    };
    let (crawling, driving) = (ratio(true), ratio(false));
    assert!((0.3..2.0).contains(&crawling), "{crawling}");
    assert!(driving > 3.0 * crawling, "{driving}");
}
