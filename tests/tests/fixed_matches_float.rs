//! Fixed point against double precision: the ten replicated experiments, and the faults of the GNSS
//! receiver in the catalogue.

use cross_tests::faults::catalogue::{Fault, catalogue, of_the_receiver};
use cross_tests::faults::drive::drive;
use cross_tests::faults::matrix::TRUCKS;
use estimator_core::filter::Filter;
use estimator_core::{Counters, FixedPoint, Scalar, Tuning};
use host_sim::comparison::Profile;
use host_sim::recorder::Recorder;
use host_sim::simulator::SimulatedRun;
use host_sim::smooth::smooth_run;
use host_sim::study::experiments::campaign::Campaign;
use host_sim::study::experiments::ours::{Ours, estimate_in};
use rayon::prelude::*;

/// Upper bounds: RMS and largest difference of the grades, %, and largest relative difference of
/// the sigmas.
const WANTED: [f64; 3] = [0.01, 0.05, 0.05];
/// Accepted part of these bounds. The resolution is far better, and a loss must not go unnoticed.
const PART_OF_WANTED: f64 = 0.01;

/// Returns the differences in the order of [`WANTED`].
fn differences(fixed: &Profile, double: &Profile) -> [f64; 3] {
    assert_eq!(fixed.grade_percent.len(), double.grade_percent.len());
    let grades = fixed.grade_percent.iter().zip(&double.grade_percent);
    let sigmas = fixed.sigma_percent.iter().zip(&double.sigma_percent);
    let mut found = [0.0_f64; 3];
    for ((a, b), (of_a, of_b)) in grades.zip(sigmas) {
        let [squares, largest, sigma] = &mut found;
        assert!(a.is_finite() && of_a.is_finite());
        *squares += (a - b).powi(2);
        *largest = largest.max((a - b).abs());
        *sigma = sigma.max((of_a / of_b - 1.0).abs());
    }
    found[0] = (found[0] / fixed.grade_percent.len() as f64).sqrt();
    found
}

fn assert_near(name: &str, fixed: &Ours, double: &Ours) {
    for (look, fixed, double) in [
        ("live", &fixed.live, &double.live),
        ("lagged", &fixed.lagged, &double.lagged),
        ("smoothed", &fixed.smoothed, &double.smoothed),
    ] {
        let found = differences(fixed, double);
        let [rms, largest, sigma] = found;
        println!("{name}, {look}: {rms:.1e} % RMS, {largest:.1e} % at most; sigma {sigma:.1e}");
        for (found, wanted) in found.iter().zip(WANTED) {
            let allowed = PART_OF_WANTED * wanted;
            assert!(*found <= allowed, "{name}, {look}: {found:.1e}");
        }
    }
    // No overflow, and the same decisions during the drive.
    assert_eq!(fixed.counters.restarts + fixed.counters.cells_unsound, 0);
    assert_eq!(fixed.counters, double.counters, "{name}");
}

#[test]
fn the_experiments_of_the_thesis() {
    let runs = Campaign::new(1).replicas();
    assert_eq!(runs.len(), 10);
    runs.par_iter().for_each(|run| {
        let fixed = estimate_in::<FixedPoint, FixedPoint>(&run.drive);
        let double = estimate_in::<f64, f64>(&run.drive);
        assert_near(&run.experiment.name(), &fixed, &double);
    });
}

/// Estimates a drive from its frames: live and lagged as on the vehicle, smoothed as on the host.
fn estimated<S: Scalar>(run: &SimulatedRun, fault: &Fault) -> Ours {
    let (vehicle, tuning) = (&run.vehicle.model, Tuning::default());
    let mut recorder = Recorder::<S>::new(vehicle.clone(), tuning.clone()).unwrap();
    for frame in fault.received(&run.frames) {
        recorder.on_frame(&frame);
    }
    let filter: Filter<S> = recorder.estimator().second_pass_filter();
    let (found, samples) = recorder.finish_with_samples().unwrap();
    let smoothed = smooth_run(vehicle, &tuning, &filter, &samples);
    let profile = |pairs: Vec<(f64, f64)>| {
        let (grade_percent, sigma_percent) = pairs.into_iter().unzip();
        Profile {
            grade_percent,
            sigma_percent,
        }
    };
    let grades = smoothed.iter().map(|cell| cell.estimate.grade_percent);
    let rows = || found.rows.iter();
    Ours {
        smoothed: profile(
            grades
                .map(|grade| (grade.value.into(), grade.sigma.into()))
                .collect(),
        ),
        lagged: profile(
            rows()
                .map(|row| (row.lagged_grade_percent, row.lagged_grade_sigma_percent))
                .collect(),
        ),
        live: profile(
            rows()
                .map(|row| (row.live_grade_percent, row.live_grade_sigma_percent))
                .collect(),
        ),
        counters: found.counters,
    }
}

#[test]
fn faults_of_the_receiver() {
    let none = catalogue().into_iter().take(1);
    let faults: Vec<Fault> = none.chain(of_the_receiver()).collect();
    for truck in TRUCKS {
        let run = drive(truck, 1).unwrap();
        faults.par_iter().for_each(|fault| {
            let fixed = estimated::<FixedPoint>(&run, fault);
            let double = estimated::<f64>(&run, fault);
            assert_near(&format!("{truck}, {}", fault.name), &fixed, &double);
            assert!(Counters::default() != fixed.counters);
        });
    }
}
