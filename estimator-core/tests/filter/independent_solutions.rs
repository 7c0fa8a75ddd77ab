//! The filter and its smoothing against independent solutions.

use estimator_core::Tuning;
use estimator_core::filter::measurement::ScalarUpdate;
use estimator_core::filter::{ModelMass, Reset, STATES, StateIndex};
use estimator_core::sample::Sample;
use nalgebra::{DMatrix, DVector};
use proptest::prelude::*;
use test_kit::dense::{BIAS, SCALE, SLOPE, WIND, LearnedByThen, dense_model, net_tractions};
use test_kit::{
    FilterRun, FilteredStep, Noise, altitude, run, run_counted, sample, smooth, speed, truck,
};

/// Observed states of a speed.
const SPEED: &[StateIndex] = &[StateIndex::KineticEnergy];
/// Observed states of a GNSS altitude.
const GNSS_ALTITUDE: &[StateIndex] = &[StateIndex::Altitude, StateIndex::GnssError];

/// Returns the variance of a measurement of a sum of states, from its S and K: S (1 − h K).
fn measured_variance(update: &ScalarUpdate<f64>, states: &[StateIndex]) -> f64 {
    let known: f64 = states.iter().map(|state| update.gain[*state]).sum();
    update.innovation_variance * (1.0 - known)
}

/// Returns what the filter has learned by the end of each cell. The noise of the force follows the
/// products of successive normalised innovations of the speed.
fn learned(cells: &[FilteredStep<f64>], tuning: &Tuning) -> Vec<LearnedByThen> {
    let noise = &tuning.measurement_noise;
    let (mut force_ratio, mut last) = (1.0, 0.0);
    cells
        .iter()
        .map(|cell| {
            let input = &cell.record.smoother_input;
            if let Some(used) = input.speed
                && input.reset == Reset::None
                && cell.record.end.condition.is_valid()
            {
                let normalised = used.innovation / used.innovation_variance.sqrt();
                let product = (normalised * last).clamp(-3.0, 3.0);
                last = normalised;
                let followed = product - f64::from(noise.force_correlation);
                force_ratio *= 1.0 + f64::from(noise.force_ratio_gain) * followed;
                force_ratio = force_ratio.clamp(1.0, f64::from(noise.force_ratio_high));
            }
            LearnedByThen {
                force_ratio,
                scale: 1.0 + cell.state.mean[StateIndex::Scale],
                scale_sigma: cell.state.sigma(StateIndex::Scale),
            }
        })
        .collect()
}

/// Returns slope and sigma of each cell, from the joint distribution of all states of all cells,
/// conditioned on all measurements at once.
fn batch(samples: &[Sample], cells: &[FilteredStep<f64>], tuning: &Tuning) -> Vec<(f64, f64)> {
    let n = samples.len();
    let size = n * STATES;
    let mut mean = DVector::zeros(size);
    let mut covariance = DMatrix::zeros(size, size);
    let net_tractions = net_tractions(samples);
    let learned = learned(cells, tuning);
    let first = &cells[0].state;
    mean.rows_mut(0, STATES)
        .copy_from(&first.mean.to_nalgebra());
    covariance
        .view_mut((0, 0), (STATES, STATES))
        .copy_from(&first.covariance.to_nalgebra());
    for (k, sample) in samples.iter().enumerate().skip(1) {
        let net_traction = (net_tractions[k - 1], net_tractions[k]);
        let (f, input, q) = dense_model(sample, net_traction, learned[k - 1], tuning);
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
    // The first state already contains the measurements of its cell.
    for (k, sample) in samples.iter().enumerate().skip(1) {
        let mut push = |states: &[StateIndex], value: f64, variance: f64| {
            let mut h = DVector::zeros(size);
            for state in states {
                h[k * STATES + *state as usize] = 1.0;
            }
            rows.push((h, value, variance));
        };
        if let (Some(speed), Some(used)) = (sample.speed, cells[k].record.smoother_input.speed) {
            let v = f64::from(speed.mean_mps);
            push(SPEED, 0.5 * v * v, measured_variance(&used, SPEED));
        }
        // Altitudes that passed the gate, with the variance that was learned by then.
        if let (Some(altitude), Some(used)) = (
            sample.altitude,
            cells[k].record.smoother_input.altitude().copied(),
        ) {
            let origin = f64::from(cells[k].state.origin_m.unwrap());
            push(
                GNSS_ALTITUDE,
                f64::from(altitude.altitude_m) - origin,
                measured_variance(&used, GNSS_ALTITUDE),
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
            h[k * STATES + WIND] = -1.0;
            h[k * STATES + SCALE] = net_tractions[k];
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
                sample.end.condition.braking = dice % 11 == 0;
                sample
            })
            .collect()
    })
}

/// Returns whether the speed of a cell was reset: its variance then contains its innovation squared.
fn has_speed_step(cell: &FilteredStep<f64>) -> bool {
    cell.record.smoother_input.speed.is_some_and(|used| {
        let square = used.innovation * used.innovation;
        let without = used.innovation_variance - square;
        (0.0..square / 25.0).contains(&without)
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    #[test]
    fn smoothing_equals_the_batch_solution(samples in random_drive()) {
        let tuning = Tuning::default();
        let (cells, counters) = run_counted::<f64>(&samples, &tuning);
        // A drive whose altitude was reset has no single joint distribution.
        let reset = |cell: &FilteredStep<f64>| cell.record.smoother_input.reset;
        prop_assume!(cells[1..].iter().all(|cell| reset(cell) == Reset::None));
        // The batch has neither the variance that a step of the speed adds, nor that of a scale
        // whose prior was reset.
        prop_assume!(!cells.iter().any(has_speed_step));
        prop_assume!(counters.scales_reopened == 0);
        // Nor that of a descent on which a brake is suspected.
        prop_assume!(!cells.iter().any(|cell| cell.record.disagreement.brake));
        // The core computes its coefficients in single precision: they agree to 1e-4 %, not more.
        let reference = batch(&samples, &cells, &tuning);
        for (k, (smoothed, (slope, sigma))) in smooth(&cells).iter().zip(&reference).enumerate() {
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
        let cells = run::<f64>(&samples, &Tuning::default());
        let last = cells.last().unwrap();
        let smoothed = *smooth(&cells).last().unwrap();
        let filtered = last.state.estimate(&ModelMass::default());
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

#[test]
fn covariance_stays_symmetric_and_positive_in_single_precision() {
    let mut run = FilterRun::<f32>::new(truck(), Tuning::default());
    let mut noise = Noise(1);
    let mut least = f64::INFINITY;
    for k in 1..=10_000_000_u32 {
        let mut s = sample(k, 5_000.0 + 3_000.0 * noise.draw(), 22.0);
        s.speed = speed(22.0 + 0.013 * noise.draw());
        if k % 9 == 0 {
            s.altitude = altitude(50.0 + noise.draw());
        }
        s.end.condition.shifting = k % 1_000 < 12;
        run.step(&s);
        if k % 10_007 == 0 {
            let p = run
                .filter
                .state()
                .unwrap()
                .covariance
                .cast::<f64>()
                .to_nalgebra();
            // Correlations, so that the units of the states do not matter.
            let scale = p.diagonal().map(|v| 1.0 / v.sqrt());
            let correlation = nalgebra::SMatrix::from_diagonal(&scale)
                * p
                * nalgebra::SMatrix::from_diagonal(&scale);
            least = least.min(correlation.symmetric_eigenvalues().min());
        }
    }
    assert_eq!(run.context.counters.restarts, 0);
    assert!(least > 0.0, "least eigenvalue of the correlation {least}");
}

#[test]
fn a_speed_that_steps_is_known_as_well_as_it_was_measured() {
    for (fast_mps, slow_mps) in [(20.0, 0.2), (35.0, 1.0), (30.0, 12.0)] {
        let mut run = FilterRun::<f32>::new(truck(), Tuning::default());
        for k in 1..=600_u32 {
            let mps = if k % 100 < 50 { fast_mps } else { slow_mps };
            let mut s = sample(k, 9_000.0, mps);
            s.speed = speed(mps);
            let state = run.step(&s).expect("a step").state;
            let least = state
                .covariance
                .cast::<f64>()
                .to_nalgebra()
                .symmetric_eigenvalues()
                .min();
            assert!(least > -1e-5, "{k}: {least}");
            assert!((state.estimate(&ModelMass::default()).speed_mps - mps).abs() < 0.5);
        }
        assert_eq!(run.context.counters.restarts, 0);
    }
}

#[test]
fn the_noise_of_the_wheel_speed_is_learned() {
    let live_sigma = |sigma: f32| {
        let mut run = FilterRun::<f64>::new(truck(), Tuning::default());
        let mut noise = Noise(9);
        let mut last = 0.0;
        for k in 1..=4_000_u32 {
            let mut s = sample(k, 4_000.0, 20.0);
            s.speed = speed(20.0 + sigma * noise.draw());
            let record = run.step(&s).unwrap().record;
            last = measured_variance(&record.smoother_input.speed.unwrap(), SPEED).sqrt();
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
