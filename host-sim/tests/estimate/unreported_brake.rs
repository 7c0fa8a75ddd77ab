//! Descents on which a brake or a retarder holds the speed, and no signal reports it.

use crate::faulty_drive::{Judged, Timed, judged, reported, simulated};
use estimator_core::Signal;

const STEEP: &str = "grade_sigma_percent = 3.0\nlargest_grade_percent = 7.0";
const RETARDER: &str =
    "[[runs.sections]]\nfrom_m = 0.0\nto_m = 30000.0\nretarder = true\nset_speed_mps = 20.0\n";
const BRAKES: [Signal; 5] = [
    Signal::BrakeSwitch,
    Signal::BrakePedal,
    Signal::BrakePressure,
    Signal::RetarderTorque,
    Signal::ParkingBrake,
];

fn without_brakes(reported: &[Timed]) -> Vec<Timed> {
    let others = reported
        .iter()
        .filter(|reading| !BRAKES.contains(&reading.1));
    others.copied().collect()
}

/// Drives a steep road with the retarder on. Returns what is found with it told and untold.
fn steep_drive(truck: &str, seed: u32) -> (Judged, Judged) {
    let run = simulated(truck, seed, 25, STEEP, RETARDER);
    let steep = run.truth.iter().filter(|row| row.grade_percent < -3.0);
    let steep = steep.count();
    assert!(
        steep > 500,
        "{truck}, seed {seed}: {steep} tenths of a second"
    );
    let told = reported(&run);
    let untold = judged(&run, &without_brakes(&told), f64::INFINITY);
    (judged(&run, &told, f64::INFINITY), untold)
}

#[test]
#[ignore = "not yet: A, seed 1: smoothed windows of 9, 0.27 %"]
fn a_silent_retarder_is_within_sigma_or_marked_and_gnss_is_nearly_always_believed() {
    for (truck, seed) in [("A", 1), ("A", 3), ("B", 3)] {
        let what = format!("{truck}, seed {seed}");
        let (told, untold) = steep_drive(truck, seed);
        // Of 1,500.
        let rejected = untold.counters.altitudes_rejected;
        assert!(rejected < 100, "{what}: {rejected}");
        untold.keeps_the_rule(&what);
        let [told, untold] = [told, untold].map(|judged| judged.of[0].rmse_percent);
        assert!(untold < 2.0 * told, "{what}: {untold} %, {told} % if told");
    }
}

#[test]
#[ignore = "not yet: A, seed 5 and B, seed 1: the live grade has windows of 12 to 14 before the first brake is found"]
fn a_silent_retarder_hardly_adds_to_the_error() {
    for truck in ["A", "B"] {
        let (told, untold) = steep_drive(truck, 1);
        untold.keeps_the_rule(truck);
        untold.is_hardly_worse_than(&told, truck);
    }
}

#[test]
fn a_descent_without_brakes_is_no_brake() {
    // The engine brakes alone: the truck gets faster, and nothing disagrees.
    let hills = "grade_sigma_percent = 1.0\nlargest_grade_percent = 2.0";
    for truck in ["A", "B"] {
        let run = simulated(truck, 5, 25, hills, "");
        let found = judged(&run, &without_brakes(&reported(&run)), f64::INFINITY);
        found.keeps_the_rule(truck);
        for of in found.of {
            assert!(of.marked < 0.01, "{truck}: {of:?}");
        }
    }
}
