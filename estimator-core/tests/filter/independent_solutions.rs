//! The filter and its smoothing against independent solutions.

use crate::batch::{SPEED, batch, has_speed_step, measured_variance, random_drive};
use estimator_core::Tuning;
use estimator_core::filter::measurement::Observation;
use estimator_core::filter::{ModelMass, Reset};
use estimator_core::sample::Sample;
use proptest::prelude::*;
use test_kit::{
    FilterRun, FilteredStep, Noise, altitude, run, run_counted, sample, smooth, speed, truck,
};

/// Checks that smoothing gives what the batch solution gives.
fn equals_the_batch(
    samples: &[Sample],
    tuning: &Tuning,
) -> Result<Vec<FilteredStep<f64>>, TestCaseError> {
    let (cells, counters) = run_counted::<f64>(samples, tuning);
    // A drive whose altitude was reset has no single joint distribution.
    let reset = |cell: &FilteredStep<f64>| cell.record.smoother_input.reset;
    prop_assume!(cells[1..].iter().all(|cell| reset(cell) == Reset::None));
    // The batch has neither the variance that a step of the speed adds, nor that of a scale whose
    // prior was reset or that was set to its bound, nor that of a descent on which a brake is suspected.
    prop_assume!(!cells.iter().any(has_speed_step));
    prop_assume!(counters.scales_reopened == 0);
    prop_assume!(
        !cells
            .iter()
            .any(|cell| cell.record.smoother_input.scale_set)
    );
    prop_assume!(!cells.iter().any(|cell| cell.record.disagreement.brake));
    // The core computes its coefficients in single precision: they agree to 1e-4 %, not more, and to a
    // small part of a sigma where the scale of a launch is open.
    let is_open = tuning.prior.launch_scale_sigma > 1.0;
    let reference = batch(samples, &cells, tuning);
    for (k, (smoothed, (slope, sigma))) in smooth(&cells).iter().zip(&reference).enumerate() {
        let sine = 0.01 * slope;
        let cosine = (1.0 - sine * sine).sqrt();
        let (grade, sigma) = (100.0 * sine / cosine, sigma / cosine.powi(3));
        let found = smoothed.grade_percent;
        let rounding = if is_open {
            5e-4 * (1.0 + grade.abs() + sigma)
        } else {
            2e-4 * (1.0 + grade.abs())
        };
        prop_assert!(
            (f64::from(found.value) - grade).abs() < rounding,
            "cell {k}: {} against {grade}",
            found.value
        );
        prop_assert!(
            (f64::from(found.sigma) / sigma - 1.0).abs() < 2e-3,
            "cell {k}: sigma {} against {sigma}",
            found.sigma
        );
    }
    Ok(cells)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    #[test]
    fn smoothing_equals_the_batch_solution(samples in random_drive()) {
        equals_the_batch(&samples, &Tuning::default())?;
    }

    #[test]
    fn a_scale_from_before_a_stop_is_smoothed_as_a_measurement(
        mut samples in random_drive(),
        stopped in 3..8_usize,
        mass_is_reported: bool,
        jump_scale_sigma in 0.0..1.0_f32,
    ) {
        let mut tuning = Tuning::default();
        // It is compared after four cells, and whatever it is.
        tuning.prior.launch_m = 10.0;
        tuning.prior.launch_scale_sigma = 10.0;
        tuning.prior.same_load_sigmas = 100.0;
        // A launch leaves the scale a sigma that its open load has or has not.
        tuning.process_noise.jump_scale_sigma = jump_scale_sigma;
        samples[stopped].after_stop = true;
        // Otherwise the load is open where the drive begins, and is compared with that of the file.
        samples[0].mass_is_reported = mass_is_reported;
        for sample in &mut samples {
            sample.end.condition.braking = false;
        }
        let cells = equals_the_batch(&samples, &tuning)?;
        let at_scale: Vec<usize> = (0..cells.len())
            .filter(|k| {
                let second = cells[*k].record.smoother_input.second;
                second.is_some_and(|(observation, _)| observation == Observation::Scale)
            })
            .collect();
        // A stop before the first comparison takes its place.
        let mut compared = vec![stopped + 3];
        if !mass_is_reported && stopped > 3 {
            compared.insert(0, 3);
        }
        prop_assert_eq!(at_scale, compared);
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
