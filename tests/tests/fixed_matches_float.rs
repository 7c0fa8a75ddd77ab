//! The live filter in fixed point against double precision: the ten replicated experiments, and the
//! faults of the GNSS receiver in the catalogue. Variances are inferred in floats only.

use cross_tests::faults::catalogue::{Fault, catalogue, of_the_receiver};
use cross_tests::faults::drive::drive;
use cross_tests::faults::matrix::TRUCKS;
use estimator_core::estimator::CellEstimator;
use estimator_core::{Cell, Context, Counters, FixedPoint, Sample, Scalar, Tuning};
use host_sim::recorder::Recorder;
use host_sim::study::experiments::campaign::Campaign;
use host_sim::study::experiments::ours;
use rayon::prelude::*;
use std::iter::from_fn;

/// Upper bounds: RMS and largest difference of the grades, %, and largest relative difference of
/// the sigmas.
const WANTED: [f64; 3] = [0.01, 0.05, 0.05];
/// Accepted part of these bounds. The resolution is far better, and a loss must not go unnoticed.
const PART_OF_WANTED: f64 = 0.03;

/// Returns the cells of a drive on assumed variances, and the counters.
fn cells<S: Scalar>(context: &Context, samples: &[Sample]) -> (Vec<Cell>, Counters) {
    let mut context = context.clone();
    let mut estimator = CellEstimator::<S>::new().without_inference();
    let mut cells = Vec::new();
    for sample in samples {
        estimator.push_and_work(&mut context, sample);
        cells.extend(from_fn(|| estimator.next_cell(&mut context)));
    }
    (cells, context.counters)
}

/// Returns the differences in the order of [`WANTED`].
fn differences(fixed: &[Cell], double: &[Cell]) -> [f64; 3] {
    assert_eq!(fixed.len(), double.len());
    let mut found = [0.0_f64; 3];
    for (fixed, double) in fixed.iter().zip(double) {
        let (a, b) = (fixed.live_grade_percent, double.live_grade_percent);
        let [squares, largest, sigma] = &mut found;
        assert!(a.value.is_finite() && a.sigma.is_finite());
        let difference = f64::from(a.value) - f64::from(b.value);
        *squares += difference.powi(2);
        *largest = largest.max(difference.abs());
        *sigma = sigma.max((f64::from(a.sigma) / f64::from(b.sigma) - 1.0).abs());
    }
    found[0] = (found[0] / fixed.len() as f64).sqrt();
    found
}

fn assert_near(name: &str, context: &Context, samples: &[Sample]) {
    let (fixed, fixed_counters) = cells::<FixedPoint>(context, samples);
    let (double, double_counters) = cells::<f64>(context, samples);
    let found = differences(&fixed, &double);
    let [rms, largest, sigma] = found;
    println!("{name}: {rms:.1e} % RMS, {largest:.1e} % at most; sigma {sigma:.1e}");
    for (found, wanted) in found.iter().zip(WANTED) {
        let allowed = PART_OF_WANTED * wanted;
        assert!(*found <= allowed, "{name}: {found:.1e}");
    }
    // No overflow, and the same decisions during the drive.
    assert!(samples.len() > 1_000 && fixed.len() > 1_000);
    assert_eq!(fixed_counters.restarts + fixed_counters.cells_unsound, 0);
    assert_eq!(fixed_counters, double_counters, "{name}");
}

#[test]
fn the_experiments_of_the_thesis() {
    let runs = Campaign::new(1).replicas();
    assert_eq!(runs.len(), 10);
    runs.par_iter().for_each(|run| {
        let samples = ours::samples(&run.drive);
        let context = ours::context(&run.drive);
        assert_near(&run.experiment.name(), &context, &samples);
    });
}

#[test]
fn faults_of_the_receiver() {
    let none = catalogue().into_iter().take(1);
    let faults: Vec<Fault> = none.chain(of_the_receiver()).collect();
    for truck in TRUCKS {
        let run = drive(truck, 1).unwrap();
        faults.par_iter().for_each(|fault| {
            let (vehicle, tuning) = (&run.vehicle.model, Tuning::default());
            let mut recorder = Recorder::<f32>::new(vehicle.clone(), tuning.clone()).unwrap();
            for frame in fault.received(&run.frames) {
                recorder.on_frame(&frame);
            }
            let (_, samples) = recorder.finish_with_samples().unwrap();
            let context = Context::new(vehicle.clone(), tuning).unwrap();
            assert_near(&format!("{truck}, {}", fault.name), &context, &samples);
        });
    }
}
