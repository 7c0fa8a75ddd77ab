//! Receivers whose fixes come late. Once the drive has shown it, the run is right from its start on.

use crate::faulty_drive::{Judged, Timed, judged, reported, simulated};
use estimator_core::{Delay, Delays, Signal};
use host_sim::files::run::RunRow;
use host_sim::simulator::SimulatedRun;
use std::collections::BTreeMap;
use std::ops::Range;

/// Returns the readings, with those of the receiver so much later.
fn late(prompt: &[Timed], late_s: f64) -> Vec<Timed> {
    const RECEIVER: [Signal; 5] = [
        Signal::Latitude,
        Signal::Longitude,
        Signal::Altitude,
        Signal::GnssSpeed,
        Signal::Course,
    ];
    let mut late = prompt.to_vec();
    for (seconds, signal, _) in &mut late {
        if RECEIVER.contains(signal) {
            *seconds += late_s;
        }
    }
    late.sort_by(|a, b| a.0.total_cmp(&b.0));
    late
}

fn place(row: &RunRow) -> Option<(f64, f64)> {
    Some((row.latitude_deg?, row.longitude_deg?))
}

fn apart_m(a: (f64, f64), b: (f64, f64)) -> f64 {
    let north = 111_132.0 * (a.0 - b.0);
    let east = 111_132.0 * a.0.to_radians().cos() * (a.1 - b.1);
    north.hypot(east)
}

/// Returns how far the places of a run are from those of another, m, by cell.
fn places_apart_m(found: &[RunRow], expected: &[RunRow]) -> BTreeMap<u32, f64> {
    let cell = |row: &RunRow| (row.distance_m / 2.5).round() as u32;
    let expected: BTreeMap<u32, &RunRow> = expected.iter().map(|row| (cell(row), row)).collect();
    let apart = |row: &RunRow| {
        let expected = expected.get(&cell(row))?;
        Some((cell(row), apart_m(place(row)?, place(expected)?)))
    };
    found.iter().filter_map(apart).collect()
}

/// Drives with a receiver so late, and checks the sigmas, and the places from 500 m on beside those
/// of a receiver in time.
fn check(what: &str, run: &SimulatedRun, late_s: f64) -> Judged {
    let what = format!("{what}, {late_s} s late");
    let prompt = reported(run);
    let expected = judged(run, &prompt, f64::INFINITY);
    let found = judged(run, &late(&prompt, late_s), f64::INFINITY);
    found.keeps_the_rule(&what);
    assert_eq!(expected.delays, Delays::default(), "{what}: in time");
    // Besides the usual 0.15 s, behind a wheel speed that is 0.03 s late.
    let Delay::Estimated { delay_s, sigma_s } = found.delays.receiver else {
        panic!("{what}: {:?}", found.delays);
    };
    let off_s = f64::from(delay_s) - (late_s + 0.12);
    assert!(
        off_s.abs() < 0.06 && sigma_s < 0.05,
        "{what}: {off_s} ± {sigma_s} s"
    );
    // Of the first 5 km, and of any others.
    let worst = found.of[0].worst;
    assert!(worst < 3.0, "{what}: {worst}");
    let apart_m = places_apart_m(&found.rows, &expected.rows);
    assert!(apart_m.len() > 7_900, "{what}: {} cells", apart_m.len());
    let largest_m = |cells: Range<u32>| {
        let apart_m = apart_m.range(cells).map(|(_, metres)| *metres);
        apart_m.fold(0.0, f64::max)
    };
    // From where it is learned on, a position is carried on from fixes that are up to 110 m behind.
    let (first_m, later_m) = (largest_m(200..800), largest_m(800..u32::MAX));
    assert!(first_m < 6.0, "{what}: {first_m} m");
    assert!(later_m < 3.0 + 2.5 * late_s, "{what}: {later_m} m");
    found
}

#[test]
fn what_came_before_it_was_learned_is_put_right() {
    for (truck, seed) in [("A", 10), ("B", 3)] {
        let run = simulated(truck, seed, 20, "", "");
        for late_s in [0.48, 2.0, 5.0] {
            check(truck, &run, late_s);
        }
    }
}

#[test]
#[ignore = "not yet: 5 s late: places are up to 20 m off on the first two kilometres, where it is learned"]
fn a_stop_before_it_is_learned_moves_no_place() {
    let run = simulated(
        "A",
        10,
        20,
        "",
        "[[runs.stops]]\nat_m = 1500.0\nseconds = 20.0\n",
    );
    for late_s in [2.0, 5.0] {
        check("stop", &run, late_s);
    }
}

#[test]
#[ignore = "not yet: 2 s late: places are up to 27 m off on the first two kilometres, where it is learned"]
fn reversing_before_it_is_learned_moves_no_place() {
    let run = simulated(
        "A",
        10,
        20,
        "",
        "[[runs.stops]]\nat_m = 1500.0\nseconds = 20.0\nreverse_m = 60.0\n",
    );
    for late_s in [2.0, 5.0] {
        let found = check("reversing", &run, late_s);
        assert_eq!(found.counters.reversals, 1);
    }
}
