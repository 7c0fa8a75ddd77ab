//! The error over a whole drive with faults of the GNSS receiver.

use estimator_core::Tuning;
use host_sim::recorder::{Recorder, SmoothedRun};
use host_sim::simulator::SimulatedRun;

/// Simulates and estimates 30 km with every parameter wrong by one sigma, wind, cold tyres, and a
/// fault at 15 km.
fn drive(truck: &str, direction: &str, seed: u32, fault: &str) -> (SimulatedRun, SmoothedRun) {
    estimated(&format!(
        "seed = {seed}\n[road]\nlength_m = 30000.0\n\
         [errors]\nmass_sigma = 0.1\ndrag_sigma = 0.1\nrolling_sigma = 0.1\ntorque_sigma = 0.04\n\
         [tyres]\ncold_amount = 0.3\n[wind]\nspeed_mps = 2.0\nfrom_deg = 250.0\n\
         gust_sigma_mps = 0.3\n\
         [gnss]\naltitude_sigma_m = 2.0\naltitude_time_s = 250.0\n\
         altitude_white_sigma_m = 0.3\n{fault}\n\
         [[runs]]\nname = \"x\"\ntruck = \"{truck}\"\ndirection = \"{direction}\"\n"
    ))
}

/// Simulates and estimates the first run of a scenario.
fn estimated(text: &str) -> (SimulatedRun, SmoothedRun) {
    let run = test_kit::simulated::run(&[text]);
    let mut recorder = Recorder::<f32>::new(run.vehicle.model.clone(), Tuning::default()).unwrap();
    for frame in &run.frames {
        recorder.on_frame(frame);
    }
    let found = recorder.finish().unwrap();
    (run, found)
}

/// Returns the mean square of the smoothed error, and that of the normalised error. Leaves out
/// 500 m at both ends.
fn squares(run: &SimulatedRun, found: &SmoothedRun) -> (f64, f64) {
    let truth: Vec<(f64, f64)> = run
        .truth
        .iter()
        .map(|row| (row.time_s, row.grade_percent))
        .collect();
    let end_m = found.rows.last().unwrap().distance_m - 500.0;
    let errors: Vec<(f64, f64)> = found
        .rows
        .iter()
        .filter(|row| (500.0..end_m).contains(&row.distance_m))
        .filter_map(|row| {
            let grade = host_sim::numeric::series::linear(&truth, row.time_s)?;
            let error = row.grade_percent - grade;
            Some((error.powi(2), (error / row.grade_sigma_percent).powi(2)))
        })
        .collect();
    let count = errors.len() as f64;
    let sum = errors
        .iter()
        .fold((0.0, 0.0), |s, e| (s.0 + e.0, s.1 + e.1));
    (sum.0 / count, sum.1 / count)
}

#[test]
fn a_fault_increases_the_error_by_little_more_than_half() {
    const FAULTS: [(&str, &str); 5] = [
        ("lost for 120 s", "outages_m = [[15000.0, 17666.0]]"),
        ("lost for 10 minutes", "outages_m = [[12000.0, 25333.0]]"),
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
    for truck in ["A", "B"] {
        let rmse = |fault: &str| {
            let mut mean = 0.0;
            let mut honest = 0.0;
            for seed in 1..=3 {
                for direction in ["forward", "backward"] {
                    let (run, found) = drive(truck, direction, seed, fault);
                    let (square, normalised) = squares(&run, &found);
                    mean += square.sqrt() / 6.0;
                    honest += normalised / 6.0;
                }
            }
            (mean, honest)
        };
        let (without, _) = rmse("");
        for (name, fault) in FAULTS {
            let (with, honest) = rmse(fault);
            println!("{truck} {name:24} {with:.4} % {:.2}", with / without);
            assert!(
                with < 1.5 * without + 0.02,
                "{truck}, {name}: {with:.4} %, {without:.4} without"
            );
            assert!(honest < 1.5, "{truck}, {name}: normalised square {honest}");
        }
    }
}

#[test]
fn a_truck_far_from_its_file_is_no_drift() {
    // Mass and torque are wrong by up to fifteen times what the filter expects: a file of a full
    // truck for an empty one. The receiver is good enough to contradict the model within the first
    // kilometre.
    for (seed, scale) in [(3, 0.75), (9, 1.47), (2, 2.40), (12, 3.16)] {
        let (run, found) = estimated(&format!(
            "seed = {seed}\n[road]\nlength_m = 20000.0\n\
             [errors]\nmass_sigma = 0.35\ntorque_sigma = 0.1\n\
             [wind]\nspeed_mps = 2.0\nfrom_deg = 250.0\ngust_sigma_mps = 0.3\n\
             [gnss]\naltitude_sigma_m = 1.0\n\
             [[runs]]\nname = \"x\"\ntruck = \"A\"\ndirection = \"backward\"\n"
        ));
        let (square, normalised) = squares(&run, &found);
        let rmse = square.sqrt();
        println!("scale {scale} {rmse:.4} % {normalised:.2}");
        assert!(rmse < 0.25, "scale {scale}: {rmse:.3} %");
        assert!(normalised < 2.0, "scale {scale}: {normalised:.2}");
        let last = found.rows.last().unwrap().scale;
        assert!((last - scale).abs() < 0.05, "{last}, expected {scale}");
    }
}
