//! Reversing: the distance stands still, no cells are made, and forward cells go on afterwards.

use estimator_core::sample::Sample;
use estimator_core::{Estimator, Instant, Reading, Signal, Step, Tuning, Value};
use test_kit::by_force;
use test_kit::readings_drive::ReadingsDrive;

/// Returns readings at a speed. Gear and course are reported if they are given.
fn at(mps: f32, gear: Option<f32>, course_deg: Option<f32>) -> Vec<(Signal, f32)> {
    let gear = gear.map(|gear| (Signal::CurrentGear, gear));
    let course = course_deg.map(|course_deg| (Signal::Course, course_deg));
    let driven = [(Signal::TractionForce, 4_000.0), (Signal::WheelSpeed, mps)];
    gear.into_iter().chain(course).chain(driven).collect()
}

/// Drives 20 s at 10 m/s to the north, and stands for 5 s. Returns the drive and its last cell.
fn before(gear: Option<f32>, course_deg: Option<f32>) -> (ReadingsDrive, Sample) {
    let mut drive = ReadingsDrive::of(by_force());
    drive.on(20.0, &at(10.0, gear, course_deg));
    drive.on(5.0, &at(0.0, gear.map(|_| 0.0), course_deg));
    let last = *drive.samples.last().unwrap();
    (drive, last)
}

#[test]
fn a_reverse_gear_makes_no_cells_and_forward_cells_go_on() {
    for back_s in [1.0, 40.0] {
        let (mut drive, last) = before(Some(6.0), None);
        let back = drive.on(back_s, &at(1.5, Some(-1.0), None));
        assert_eq!(back, []);
        assert_eq!(drive.context.counters.reversals, 1);
        assert_eq!(drive.on(3.0, &at(0.0, Some(0.0), None)), []);
        let forward = drive.on(20.0, &at(10.0, Some(6.0), None));
        let (first, end) = (forward[0], forward[forward.len() - 1]);
        // It does not follow the last one, and is no further away.
        assert_eq!(first.end.cell, last.end.cell + 1);
        assert_eq!(first.gap_cells, 1);
        assert!(forward[1..].iter().all(|sample| sample.gap_cells == 0));
        let driven_m = end.end.distance_m() - last.end.distance_m();
        // Steps of the speed count after a second.
        assert!((driven_m - 195.0).abs() < 8.0, "{driven_m} m");
        assert_eq!(drive.context.counters.reversals, 1);
    }
}

#[test]
fn a_vehicle_that_rolls_on_in_neutral_still_reverses() {
    let (mut drive, _) = before(Some(6.0), None);
    drive.on(10.0, &at(1.5, Some(-1.0), None));
    assert_eq!(drive.on(10.0, &at(1.0, Some(0.0), None)), []);
    assert!(drive.on(10.0, &at(1.0, Some(1.0), None)).len() > 2);
}

#[test]
fn altitudes_and_speeds_in_reverse_leave_nothing_behind() {
    let (mut drive, _) = before(Some(6.0), None);
    let mut readings = at(1.5, Some(-1.0), None);
    readings.insert(0, (Signal::Altitude, 777.0));
    readings.insert(0, (Signal::Satellites, 9.0));
    drive.on(20.0, &readings);
    for sample in drive.on(5.0, &at(10.0, Some(6.0), None)) {
        assert_eq!(sample.altitude, None);
        if let Some(speed) = sample.speed {
            assert!((speed.mean_mps - 10.0).abs() < 0.01, "{speed:?}");
        }
    }
}

#[test]
fn without_a_gear_the_course_shows_it() {
    for (north_deg, back_deg) in [(0.0, 180.0), (90.0, 270.0), (350.0, 165.0), (10.0, 195.0)] {
        let (mut drive, last) = before(None, Some(north_deg));
        let back = drive.on(30.0, &at(1.5, None, Some(back_deg)));
        assert_eq!(back, []);
        assert_eq!(drive.context.counters.reversals, 1);
        drive.on(5.0, &at(0.0, None, Some(back_deg)));
        let forward = drive.on(20.0, &at(10.0, None, Some(north_deg)));
        assert_eq!(forward[0].end.cell, last.end.cell + 1);
        let driven_m = forward[forward.len() - 1].end.distance_m() - last.end.distance_m();
        assert!((190.0..=205.0).contains(&driven_m), "{driven_m} m");
    }
}

#[test]
fn cells_since_a_stop_wait_for_a_course() {
    // The receiver holds its course for some seconds.
    for (course_deg, is_back) in [(180.0, true), (0.0, false)] {
        let (mut drive, last) = before(None, Some(0.0));
        assert_eq!(drive.on(5.0, &at(1.5, None, None)), []);
        let moved = drive.on(20.0, &at(1.5, None, Some(course_deg)));
        assert_eq!(moved.is_empty(), is_back);
        drive.on(5.0, &at(0.0, None, Some(course_deg)));
        let forward = drive.on(20.0, &at(10.0, None, Some(0.0)));
        let before_m = if is_back { 0.0 } else { 25.0 * 1.5 };
        let driven_m = forward[forward.len() - 1].end.distance_m() - last.end.distance_m();
        assert!(
            (before_m + 190.0..=before_m + 205.0).contains(&driven_m),
            "{driven_m} m"
        );
    }
}

#[test]
fn a_receiver_that_never_says_a_course_again_holds_nothing_up() {
    let (mut drive, _) = before(None, Some(0.0));
    let moved = drive.on(20.0, &at(1.5, None, None));
    assert!(moved.len() > 10, "{}", moved.len());
}

#[test]
fn a_course_that_turns_while_driving_or_is_held_is_no_reversing() {
    // A hairpin bend.
    let mut drive = ReadingsDrive::of(by_force());
    for step in 0..=20_u8 {
        let course_deg = 9.0 * f32::from(step);
        assert!(!drive.on(2.0, &at(5.0, None, Some(course_deg))).is_empty());
    }
    // A junction: the vehicle stops, and turns by a right angle.
    drive.on(5.0, &at(0.0, None, Some(180.0)));
    assert!(drive.on(10.0, &at(5.0, None, Some(270.0))).len() > 15);
    // A receiver that scatters its course while the vehicle stands.
    for step in 0..20_u8 {
        drive.on(0.5, &at(0.0, None, Some(f32::from(step) * 77.0 % 360.0)));
    }
    assert!(drive.on(10.0, &at(5.0, None, Some(270.0))).len() > 15);
    assert_eq!(drive.context.counters.reversals, 0);
}

#[test]
fn a_vehicle_that_stops_in_reverse_goes_on_reversing() {
    let (mut drive, _) = before(None, Some(170.0));
    drive.on(20.0, &at(1.5, None, Some(350.0)));
    drive.on(5.0, &at(0.0, None, Some(350.0)));
    // Its heading is that of the course turned round, so more than a turn away from this one.
    assert_eq!(drive.on(20.0, &at(1.5, None, Some(10.0))), []);
    drive.on(5.0, &at(0.0, None, Some(10.0)));
    assert!(drive.on(20.0, &at(5.0, None, Some(175.0))).len() > 30);
    assert_eq!(drive.context.counters.reversals, 1);
}

#[test]
fn a_vehicle_whose_gearbox_falls_silent_in_reverse_goes_on_reversing() {
    let (mut drive, _) = before(None, Some(170.0));
    drive.on(20.0, &at(4.0, Some(-1.0), Some(350.0)));
    // The gear is stale after five seconds.
    drive.on(10.0, &at(0.0, None, Some(350.0)));
    assert_eq!(drive.on(20.0, &at(1.5, None, Some(10.0))), []);
    assert_eq!(drive.context.counters.reversals, 1);
}

#[test]
fn the_course_of_a_vehicle_that_creeps_shows_nothing() {
    let (mut drive, _) = before(None, Some(0.0));
    assert!(drive.on(20.0, &at(0.6, None, Some(180.0))).len() > 3);
    assert_eq!(drive.context.counters.reversals, 0);
}

#[test]
fn an_estimator_makes_no_cell_in_reverse_and_counts_none_twice() {
    let mut estimator = Estimator::<f32>::new(by_force(), Tuning::default()).unwrap();
    let mut tick = 0_u64;
    let mut drive = |seconds: u64, mps: f32, course_deg: Option<f32>| {
        let mut cells = Vec::new();
        for _ in 0..10 * seconds {
            tick += 1;
            for (signal, value) in at(mps, None, course_deg) {
                let value = Value::Real(value);
                let now = Instant::from_micros(100_000 * tick);
                estimator.on_reading(now, Reading { signal, value });
                while let Some(step) = estimator.step() {
                    let live = estimator.live().filter(|_| step == Step::Moved);
                    cells.extend(live.map(|live| live.end.cell));
                }
            }
        }
        cells
    };
    let before = drive(20, 10.0, Some(0.0));
    drive(5, 0.0, Some(0.0));
    // The receiver says no course for the first metres.
    assert!(drive(4, 1.5, None).is_empty());
    assert!(drive(20, 1.5, Some(180.0)).is_empty());
    drive(5, 0.0, Some(180.0));
    let after = drive(20, 10.0, Some(0.0));
    let gap = after[0] - before[before.len() - 1];
    assert!((1..=4).contains(&gap), "{gap} cells");
    assert!(after.is_sorted_by(|a, b| a < b), "{after:?}");
}
