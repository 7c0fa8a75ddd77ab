//! Fixed point against double precision: the ten replicated experiments, and the faults of GNSS.

use estimator_core::filter::Filter;
use estimator_core::{Counters, Fixed, Scalar, Tuning};
use host_sim::baseline::Profile;
use host_sim::recorder::Recorder;
use host_sim::smooth::smooth_run;
use host_sim::study::experiments::ours::{Ours, estimate_in};
use host_sim::study::experiments::replica::Campaign;
use host_sim::world::scenario::Scenario;
use host_sim::world::{SimulatedRun, simulate};
use rayon::prelude::*;
use std::path::Path;

/// What is wanted at most: root mean square and largest difference of grades, %, and the largest
/// of sigmas as a part.
const WANTED: [f64; 3] = [0.01, 0.05, 0.05];
/// The words resolve far more; what they lose must not grow unseen.
const PART_OF_WANTED: f64 = 0.01;

/// Differences as in [`WANTED`].
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
    // No overflow, and the same decisions on the way.
    assert_eq!(fixed.counters.restarts + fixed.counters.cells_unsound, 0);
    assert_eq!(fixed.counters, double.counters, "{name}");
}

#[test]
fn the_experiments_of_the_thesis() {
    let runs = Campaign::new(1).replicas();
    assert_eq!(runs.len(), 10);
    runs.par_iter().for_each(|run| {
        let fixed = estimate_in::<Fixed, Fixed>(&run.drive);
        let double = estimate_in::<f64, f64>(&run.drive);
        assert_near(&run.experiment.name(), &fixed, &double);
    });
}

/// 30 km with everything wrong by one sigma, wind, cold tyres, and a fault of GNSS half-way.
fn drive(truck: &str, fault: &str) -> SimulatedRun {
    let text = format!(
        "seed = 1\n[road]\nlength_m = 30000.0\n\
         [errors]\nmass_sigma = 0.1\ndrag_sigma = 0.1\nrolling_sigma = 0.1\ntorque_sigma = 0.04\n\
         [tyres]\ncold_amount = 0.3\n\
         [wind]\nspeed_mps = 2.0\nfrom_deg = 250.0\ngust_sigma_mps = 0.3\n\
         [gnss]\naltitude_sigma_m = 2.0\naltitude_time_s = 250.0\naltitude_white_sigma_m = 0.3\n\
         {fault}\n[[runs]]\nname = \"x\"\ntruck = \"{truck}\"\n"
    );
    let scenario = Scenario::parse(&text, Path::new("faults")).unwrap();
    simulate(&scenario, 0).unwrap()
}

/// From the frames on the bus, as the vehicle and then the host have it.
fn estimated<S: Scalar>(run: &SimulatedRun) -> Ours {
    let (vehicle, tuning) = (&run.vehicle.parameters, Tuning::default());
    let mut recorder = Recorder::<S>::new(vehicle.clone(), tuning.clone()).unwrap();
    for frame in &run.frames {
        recorder.on_frame(frame);
    }
    let filter: Filter<S> = recorder.estimator().filter_anew();
    let (found, samples) = recorder.finish_with_samples();
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
    const FAULTS: [(&str, &str); 7] = [
        ("no fault", ""),
        ("lost for 120 s", "outages_m = [[15000.0, 17666.0]]"),
        ("lost for 10 minutes", "outages_m = [[12000.0, 25333.0]]"),
        ("never there", "outages_m = [[0.0, 40000.0]]"),
        ("25 m off for 60 s", "steps = [[15000.0, 16333.0, 25.0]]"),
        (
            "1 m per 100 m for 1 km",
            "ramps = [[15000.0, 16000.0, 10.0]]",
        ),
        (
            "-1 m per 100 m for 1 km",
            "ramps = [[15000.0, 16000.0, -10.0]]",
        ),
    ];
    let runs: Vec<_> = ["A", "B"]
        .into_iter()
        .flat_map(|truck| FAULTS.map(|(name, fault)| (truck, name, fault)))
        .collect();
    runs.par_iter().for_each(|(truck, name, fault)| {
        let run = drive(truck, fault);
        let fixed = estimated::<Fixed>(&run);
        assert_near(&format!("{truck}, {name}"), &fixed, &estimated::<f64>(&run));
        assert!(Counters::default() != fixed.counters);
    });
}
