//! The filter and its smoothing against independent solutions.

mod common;

use common::{altitude, sample, speed, truck};
use estimator_core::filter::covariance::to_vector;
use estimator_core::filter::record::Link;
use estimator_core::filter::state::{ALTITUDE, BIAS, ENERGY, GNSS_ERROR, SCALE, SLOPE, SLOPE_RATE};
use estimator_core::filter::{Backward, Filter, Record, STATES};
use estimator_core::sampler::Sample;
use estimator_core::{Counters, Estimate, Scalar, Tuning};
use nalgebra::{DMatrix, DVector};
use proptest::prelude::*;

fn run<S: Scalar>(samples: &[Sample], tuning: &Tuning) -> Vec<Record<S>> {
    let vehicle = truck();
    let mut filter = Filter::new();
    let mut counters = Counters::default();
    samples
        .iter()
        .filter_map(|sample| filter.step(&vehicle, tuning, sample, &mut counters))
        .collect()
}

fn smooth<S: Scalar>(records: &[Record<S>]) -> Vec<Estimate> {
    let mut backward = Backward::new();
    let mut estimates: Vec<_> = records
        .iter()
        .rev()
        .map(|record| {
            backward.absorb(record);
            let estimate = backward.estimate(record);
            backward.retreat(record);
            estimate
        })
        .collect();
    estimates.reverse();
    estimates
}

/// Traction less air resistance over weight in %, cell by cell, held while the model is invalid.
fn loads(samples: &[Sample]) -> Vec<f64> {
    let mut held = None;
    samples
        .iter()
        .map(|sample| {
            let weight = f64::from(sample.load.mass_kg) * 9.806_65;
            let mps = f64::from(sample.place.speed_mps);
            let air_n = 0.5
                * f64::from(truck().drag_area_m2)
                * f64::from(sample.load.air_density)
                * mps
                * mps;
            let now = 100.0 * (f64::from(sample.load.traction_n) - air_n) / weight;
            let load = match held {
                Some(held) if !sample.place.condition.is_valid() => held,
                _ => now,
            };
            held = Some(load);
            load
        })
        .collect()
}

/// Transition and noise of one sample, written down from the model as a dense matrix: eq. 9 in
/// e = v²/2 over one cell with the slope at its middle, Gauss-Markov slow states.
fn dense_model(
    sample: &Sample,
    load: (f64, f64),
    tuning: &Tuning,
) -> (DMatrix<f64>, DVector<f64>, DVector<f64>) {
    let vehicle = truck();
    let (mass, length) = (f64::from(sample.load.mass_kg), 2.5);
    let accelerated = mass + f64::from(sample.load.rotating_kg);
    let g = 9.806_65;
    let drag =
        f64::from(vehicle.drag_area_m2) * f64::from(sample.load.air_density) / accelerated * length;
    let gravity = mass * g / accelerated * length / 100.0;
    let rolling = mass * g * f64::from(vehicle.rolling_resistance) / accelerated * length;
    let traction = f64::from(sample.load.traction_n) / accelerated * length;
    let keep = |ratio: f64| 1.0 / (1.0 + ratio);
    let energy = 1.0 - drag + 0.5 * drag * drag;

    let mut f = DMatrix::<f64>::identity(STATES, STATES);
    let change = load.1 - load.0;
    let limit = f64::from(tuning.load_change_percent);
    let jump = change - change.clamp(-limit, limit);
    f[(ENERGY, ENERGY)] = energy;
    f[(ENERGY, SLOPE)] = -gravity * energy;
    f[(ENERGY, SLOPE_RATE)] = -gravity * 0.5 * length * energy;
    f[(ENERGY, SCALE)] = gravity * jump * energy;
    f[(ALTITUDE, SLOPE)] = length / 100.0;
    f[(ALTITUDE, SLOPE_RATE)] = length * 0.5 * length / 100.0;
    f[(ALTITUDE, BIAS)] = -length / 100.0;
    f[(ALTITUDE, SCALE)] = (load.1 - jump) * length / 100.0;
    f[(SLOPE, SLOPE_RATE)] = length;
    f[(SLOPE, SCALE)] = -jump;
    let rate = keep(length / f64::from(tuning.slope_rate_length_m));
    let bias = keep(length / f64::from(tuning.bias_length_m));
    let error = keep(f64::from(sample.duration_s) / f64::from(tuning.gnss_error_time_s));
    f[(SLOPE_RATE, SLOPE_RATE)] = rate;
    f[(BIAS, BIAS)] = bias;
    f[(GNSS_ERROR, GNSS_ERROR)] = error;

    let mut input = DVector::zeros(STATES);
    input[ENERGY] = traction - rolling;

    let weight = mass * g;
    let mps = f64::from(sample.place.speed_mps);
    let air_n =
        0.5 * f64::from(vehicle.drag_area_m2) * f64::from(sample.load.air_density) * mps * mps;
    let bias_sigma = 100.0
        * ((f64::from(tuning.bias_force_n) / weight).powi(2)
            + (f64::from(tuning.bias_rolling) * f64::from(vehicle.rolling_resistance)).powi(2)
            + (f64::from(tuning.bias_drag) * air_n / weight).powi(2))
        .sqrt();
    let model = if sample.place.condition.is_valid() {
        100.0 * f64::from(tuning.force_noise_n) / weight
    } else {
        f64::from(tuning.invalid_noise_percent)
    };
    let mut q = DVector::zeros(STATES);
    q[ENERGY] = (gravity * model).powi(2);
    q[SLOPE_RATE] = (1.0 - rate * rate) * f64::from(tuning.slope_rate_sigma).powi(2);
    q[BIAS] = (1.0 - bias * bias) * bias_sigma * bias_sigma;
    q[SCALE] = f64::from(tuning.scale_walk_per_sqrt_km).powi(2) * length / 1000.0;
    q[GNSS_ERROR] = (1.0 - error * error) * f64::from(tuning.gnss_error_sigma_m).powi(2);
    (f, input, q)
}

/// The joint distribution of all states of all cells, conditioned on all measurements at once.
fn batch(samples: &[Sample], records: &[Record<f64>], tuning: &Tuning) -> Vec<(f64, f64)> {
    let n = samples.len();
    let size = n * STATES;
    let mut mean = DVector::zeros(size);
    let mut covariance = DMatrix::zeros(size, size);
    let loads = loads(samples);
    let first = &records[0].predicted;
    mean.rows_mut(0, STATES).copy_from(&to_vector(&first.x));
    covariance
        .view_mut((0, 0), (STATES, STATES))
        .copy_from(&first.p.to_matrix());
    for (k, sample) in samples.iter().enumerate().skip(1) {
        let (f, input, q) = dense_model(sample, (loads[k - 1], loads[k]), tuning);
        let (now, before) = (k * STATES, (k - 1) * STATES);
        let moved = &f * mean.rows(before, STATES) + input;
        mean.rows_mut(now, STATES).copy_from(&moved);
        let cross = &f * covariance.view((before, 0), (STATES, now));
        covariance
            .view_mut((now, 0), (STATES, now))
            .copy_from(&cross);
        covariance
            .view_mut((0, now), (now, STATES))
            .copy_from(&cross.transpose());
        let within = &f * covariance.view((before, before), (STATES, STATES)) * f.transpose()
            + DMatrix::from_diagonal(&q);
        covariance
            .view_mut((now, now), (STATES, STATES))
            .copy_from(&within);
    }
    let mut rows = Vec::new();
    for (k, sample) in samples.iter().enumerate() {
        let mut push = |states: &[usize], value: f64, variance: f64| {
            let mut h = DVector::zeros(size);
            for state in states {
                h[k * STATES + state] = 1.0;
            }
            rows.push((h, value, variance));
        };
        if let (Some(speed), Some(used)) = (sample.speed, records[k].speed) {
            let v = f64::from(speed.mean_mps);
            push(&[ENERGY], 0.5 * v * v, used.variance);
        }
        // Those that the gate let pass; all with the variance that had been learned by then.
        if let (Some(altitude), Some(used)) = (sample.altitude, records[k].altitude) {
            let origin = f64::from(records[k].predicted.origin_m.unwrap());
            push(
                &[ALTITUDE, GNSS_ERROR],
                f64::from(altitude.altitude_m) - origin,
                used.variance,
            );
        }
    }
    let h = DMatrix::from_fn(rows.len(), size, |i, j| rows[i].0[j]);
    let y = DVector::from_fn(rows.len(), |i, _| rows[i].1);
    let r = DMatrix::from_diagonal(&DVector::from_fn(rows.len(), |i, _| rows[i].2));
    let cross = &covariance * h.transpose();
    let solve = (&h * &cross + r).cholesky().unwrap();
    let posterior = &mean + &cross * solve.solve(&(y - &h * &mean));
    let spread = &covariance - &cross * solve.solve(&cross.transpose());
    (0..n)
        .map(|k| {
            let mut h = DVector::zeros(size);
            h[k * STATES + SLOPE] = 1.0;
            h[k * STATES + BIAS] = -1.0;
            h[k * STATES + SCALE] = loads[k];
            (h.dot(&posterior), (h.transpose() * &spread * &h)[0].sqrt())
        })
        .collect()
}

/// A drive at about 20 m/s whose every measurement is random, altitude from the first cell on.
fn random_drive() -> impl Strategy<Value = Vec<Sample>> {
    let step = (
        -8_000.0..16_000.0_f32,
        19.9..20.1_f32,
        -1.5..1.5_f32,
        0..100_u8,
    );
    prop::collection::vec(step, 12..40).prop_map(|steps| {
        steps
            .iter()
            .enumerate()
            .map(|(k, (force, mps, metres, dice))| {
                let mut sample = sample(k as u32 + 1, *force, 20.0);
                if k == 0 || dice % 5 != 0 {
                    sample.speed = speed(*mps);
                }
                if k == 0 || dice % 7 == 0 {
                    sample.altitude = altitude(100.0 + metres);
                }
                sample.place.condition.braking = dice % 11 == 0;
                sample
            })
            .collect()
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    #[test]
    fn smoothing_equals_the_batch_solution(samples in random_drive()) {
        let tuning = Tuning::default();
        let records = run::<f64>(&samples, &tuning);
        // A drive whose altitude was set anew has no single joint distribution.
        prop_assume!(records[1..].iter().all(|record| record.link == Link::Chained));
        // The core forms its coefficients in single precision: agreement to 1e-4 %, not more.
        let reference = batch(&samples, &records, &tuning);
        for (k, (smoothed, (slope, sigma))) in smooth(&records).iter().zip(&reference).enumerate() {
            let sine = 0.01 * slope;
            let cosine = (1.0 - sine * sine).sqrt();
            let (grade, sigma) = (100.0 * sine / cosine, sigma / cosine.powi(3));
            let found = smoothed.grade_percent;
            prop_assert!((f64::from(found.value) - grade).abs() < 2e-4 * (1.0 + grade.abs()),
                "cell {k}: {} against {grade}", found.value);
            prop_assert!((f64::from(found.sigma) / sigma - 1.0).abs() < 2e-3,
                "cell {k}: sigma {} against {sigma}", found.sigma);
        }
    }

    #[test]
    fn the_last_smoothed_cell_is_the_filtered_one(samples in random_drive()) {
        let records = run::<f64>(&samples, &Tuning::default());
        let last = records.last().unwrap();
        let smoothed = *smooth(&records).last().unwrap();
        let filtered = last.filtered().estimate();
        prop_assert!((smoothed.grade_percent.value - filtered.grade_percent.value).abs() < 1e-5);
        prop_assert!((smoothed.grade_percent.sigma - filtered.grade_percent.sigma).abs() < 1e-5);
    }

    #[test]
    fn single_precision_follows_double(samples in random_drive()) {
        let tuning = Tuning::default();
        let double = smooth(&run::<f64>(&samples, &tuning));
        let single = smooth(&run::<f32>(&samples, &tuning));
        for (a, b) in double.iter().zip(&single) {
            prop_assert!((a.grade_percent.value - b.grade_percent.value).abs() < 5e-3);
            prop_assert!((a.grade_percent.sigma / b.grade_percent.sigma - 1.0).abs() < 0.02);
        }
    }
}

/// Noise that a computer with a pencil can repeat.
struct Noise(u64);

impl Noise {
    fn next(&mut self) -> f32 {
        let mut sum = 0.0;
        for _ in 0..12 {
            self.0 = self
                .0
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1);
            sum += (self.0 >> 40) as f32 / (1_u64 << 24) as f32;
        }
        sum - 6.0
    }
}

#[test]
fn covariance_stays_symmetric_and_positive_in_single_precision() {
    let (vehicle, tuning) = (truck(), Tuning::default());
    let mut filter = Filter::<f32>::new();
    let mut counters = Counters::default();
    let mut noise = Noise(1);
    let mut least = f64::INFINITY;
    for k in 1..=300_000_u32 {
        let mut s = sample(k, 5_000.0 + 3_000.0 * noise.next(), 22.0);
        s.speed = speed(22.0 + 0.013 * noise.next());
        if k % 9 == 0 {
            s.altitude = altitude(50.0 + noise.next());
        }
        s.place.condition.shifting = k % 1_000 < 12;
        filter.step(&vehicle, &tuning, &s, &mut counters);
        if k % 1_000 == 0 {
            let p = filter.state().unwrap().p.to_matrix();
            // Correlations, so that the units of the states do not matter.
            let scale = p.diagonal().map(|v| 1.0 / v.sqrt());
            let correlation = nalgebra::SMatrix::from_diagonal(&scale)
                * p
                * nalgebra::SMatrix::from_diagonal(&scale);
            least = least.min(correlation.symmetric_eigenvalues().min());
        }
    }
    assert_eq!(counters.restarts, 0);
    assert!(least > 0.0, "least eigenvalue of the correlation {least}");
}

/// A level drive with good altitudes but for `fault`, which tells what a fix is off by.
fn level_drive(fault: impl Fn(u32) -> f32) -> (Vec<Record<f64>>, Counters) {
    let vehicle = truck();
    let weight_n = vehicle.mass_kg * 9.806_65;
    let air_n = 0.5 * vehicle.drag_area_m2 * 1.2 * 400.0;
    let force_n = air_n + weight_n * vehicle.rolling_resistance;
    let mut filter = Filter::new();
    let mut counters = Counters::default();
    let mut noise = Noise(3);
    let records = (1..=4_000_u32)
        .map(|k| {
            let mut s = sample(k, force_n, 20.0);
            s.speed = speed(20.0 + 0.013 * noise.next());
            if k % 8 == 0 {
                s.altitude = altitude(100.0 + 0.3 * noise.next() + fault(k));
            }
            let step = filter.step(&vehicle, &Tuning::default(), &s, &mut counters);
            step.expect("every sample has a speed")
        })
        .collect();
    (records, counters)
}

fn worst_grade(records: &[Record<f64>]) -> f32 {
    let late = &smooth(records)[400..];
    late.iter()
        .map(|e| e.grade_percent.value.abs())
        .fold(0.0, f32::max)
}

#[test]
fn a_single_wild_altitude_is_left_out() {
    let (clean, _) = level_drive(|_| 0.0);
    let (records, counters) = level_drive(|k| if k % 400 == 0 { 40.0 } else { 0.0 });
    assert_eq!(counters.altitudes_rejected, 10);
    assert_eq!(counters.altitude_resets, 1, "the first fix only");
    assert!(worst_grade(&records) < worst_grade(&clean) + 0.02);
}

#[test]
fn a_step_of_the_receiver_moves_neither_slope_nor_altitude() {
    let (clean, _) = level_drive(|_| 0.0);
    let (records, counters) = level_drive(|k| {
        if (1_500..2_000).contains(&k) {
            25.0
        } else {
            0.0
        }
    });
    assert_eq!(counters.altitude_resets, 1, "the first fix");
    // The way back is no surprise once the error is known to be large.
    assert!((1..=2).contains(&counters.altitude_steps));
    assert!(counters.altitudes_rejected < 10);
    assert!(worst_grade(&records) < worst_grade(&clean) + 0.02);
    let altitude = |k: usize| records[k].filtered().estimate().altitude_m.unwrap().value;
    assert!((altitude(1_700) - altitude(1_400)).abs() < 3.0);
    assert!((altitude(2_300) - altitude(1_400)).abs() < 3.0);
}

#[test]
fn a_noisy_receiver_is_learned_and_not_picked_from() {
    let mut noise = Noise(5);
    let draws: Vec<f32> = (0..=4_000).map(|_| 3.0 * noise.next()).collect();
    let (records, counters) = level_drive(|k| draws[k as usize]);
    // Of 500 fixes; a gate that did not learn would leave out most.
    assert!(
        counters.altitudes_rejected < 40,
        "{}",
        counters.altitudes_rejected
    );
    assert!(worst_grade(&records) < 0.25, "{}", worst_grade(&records));
}

#[test]
fn the_noise_of_the_wheel_speed_is_learned() {
    let vehicle = truck();
    let live_sigma = |sigma: f32| {
        let mut filter = Filter::<f64>::new();
        let mut counters = Counters::default();
        let mut noise = Noise(9);
        let mut last = 0.0;
        for k in 1..=4_000_u32 {
            let mut s = sample(k, 4_000.0, 20.0);
            s.speed = speed(20.0 + sigma * noise.next());
            let record = filter.step(&vehicle, &Tuning::default(), &s, &mut counters);
            last = record.unwrap().speed.unwrap().variance.sqrt();
        }
        last / 20.0
    };
    for sigma in [0.006, 0.013, 0.03] {
        let learned = live_sigma(sigma);
        assert!(
            (learned / f64::from(sigma) - 1.0).abs() < 0.25,
            "{sigma}: {learned}"
        );
    }
}
