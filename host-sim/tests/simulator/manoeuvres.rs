//! Stops and sections of a run: what is true, and what the bus reports.

use estimator_core::Signal;
use host_sim::simulator::scenario::Scenario;
use host_sim::simulator::{Recording, SimulatedRun};
use std::path::Path;
use test_kit::simulated::{A, MILD, QUIET, run, scenario, series};

fn with(manoeuvres: &str) -> SimulatedRun {
    run(&[QUIET, MILD, A, manoeuvres])
}

fn key_error(manoeuvres: &str) -> String {
    let text = [MILD, A, manoeuvres].concat();
    Scenario::parse(&text, Path::new("test"))
        .unwrap_err()
        .to_string()
}

#[test]
fn a_truck_stops_near_the_place_and_drives_on() {
    let run = with("[[runs.stops]]\nat_m = 2000.0\nseconds = 30.0\n");
    let still: Vec<_> = run
        .truth
        .windows(2)
        .filter(|pair| pair[0].distance_m == pair[1].distance_m)
        .collect();
    let seconds = 0.1 * still.len() as f64;
    assert!((seconds - 30.0).abs() < 1.0, "{seconds} s");
    let at_m = still[0][0].distance_m;
    assert!((1_900.0..2_100.0).contains(&at_m), "{at_m} m");
    assert!(run.truth.last().unwrap().distance_m > 4_900.0);
}

#[test]
fn reversing_reports_the_gear_and_moves_the_place_back() {
    let text = "[[runs.stops]]\nat_m = 2000.0\nseconds = 10.0\nreverse_m = 50.0\n";
    let scenario = scenario(&[QUIET, MILD, A, text]);
    let recording = Recording::new(&scenario, 0).unwrap();
    let states = &recording.drive().states;
    let back: Vec<_> = states.iter().filter(|state| state.is_reversing()).collect();
    let back_m = back[0].distance_m - back.last().unwrap().distance_m;
    assert!((back_m - 50.0).abs() < 0.1, "{back_m} m");
    assert!(back[0].driven_m() - back.last().unwrap().driven_m() < 1e-6);
    let truth = recording.truth();
    assert!(truth.is_sorted_by(|a, b| a.distance_m <= b.distance_m + 1e-6));
    let run = with(text);
    let reverse = series(&run, Signal::CurrentGear);
    let reverse: Vec<f64> = reverse.iter().filter(|g| g.1 < 0.0).map(|g| g.0).collect();
    let (from_s, to_s) = (reverse[0] + 5.0, reverse.last().unwrap() - 2.0);
    let speeds = series(&run, Signal::WheelSpeed);
    let mut moving = speeds.iter().filter(|s| (from_s..to_s).contains(&s.0));
    assert!(moving.all(|speed| speed.1 > 0.0));
    let course = |at_s: f64| {
        let courses = series(&run, Signal::Course);
        courses
            .into_iter()
            .find(|course| course.0 >= at_s)
            .unwrap()
            .1
    };
    let turned_deg = (course(from_s + 5.0) - course(reverse[0] - 15.0)).rem_euclid(360.0);
    assert!((turned_deg - 180.0).abs() < 12.0, "{turned_deg}°");
}

#[test]
fn another_mass_needs_another_torque() {
    let text = "[[runs.stops]]\nat_m = 1000.0\nmass_kg = 15000.0\n";
    let scenario = scenario(&[QUIET, MILD, A, text]);
    let recording = Recording::new(&scenario, 0).unwrap();
    let states = &recording.drive().states;
    let (first, last) = (states[0], states[states.len() - 1]);
    assert!((first.accelerated_kg - last.accelerated_kg - 24_000.0).abs() < 100.0);
}

#[test]
fn a_ferry_carries_the_standing_vehicle() {
    let text = "[[runs.stops]]\nat_m = 1000.0\nseconds = 100.0\ncarried_m = 2000.0\n";
    let scenario = scenario(&[QUIET, MILD, A, text]);
    let recording = Recording::new(&scenario, 0).unwrap();
    let last = recording.drive().states.last().copied().unwrap();
    assert!(
        (last.set_back_m + 2_000.0).abs() < 1.0,
        "{} m",
        last.set_back_m
    );
    let run = with(text);
    let speeds = series(&run, Signal::GnssSpeed);
    let count = speeds
        .iter()
        .filter(|speed| (speed.1 - 20.0).abs() < 0.1)
        .count();
    assert!(count > 300, "{count} readings at 20 m/s");
}

#[test]
fn a_transfer_case_raises_the_engine_speed_alone() {
    let text = "[[runs.sections]]\nfrom_m = 2000.0\nto_m = 3000.0\nrange_ratio = 2.0\n\
                set_speed_mps = 10.0\n";
    let scenario = scenario(&[QUIET, MILD, A, text]);
    let recording = Recording::new(&scenario, 0).unwrap();
    let drive = recording.drive();
    let inside = drive
        .states
        .iter()
        .find(|s| s.distance_m > 2_900.0 && s.engaged)
        .unwrap();
    assert!(
        (inside.speed_mps - 10.0).abs() < 1.0,
        "{} m/s",
        inside.speed_mps
    );
    let without = drive.truck.engine_rpm(inside.gear, inside.speed_mps);
    assert!((inside.engine_rpm / without - 2.0).abs() < 0.01);
}

#[test]
fn rolling_wind_take_off_and_retarder_act_in_their_section() {
    let torque = |section: &str| {
        let text = format!("[[runs.sections]]\nfrom_m = 2000.0\nto_m = 4000.0\n{section}\n");
        let scenario = scenario(&[QUIET, MILD, A, &text]);
        let recording = Recording::new(&scenario, 0).unwrap();
        let within = recording.drive().states.iter();
        let within = within.filter(|s| (3_000.0..4_000.0).contains(&s.distance_m));
        let torques: Vec<f64> = within.map(|s| s.net_torque_nm).collect();
        torques.iter().sum::<f64>() / torques.len() as f64
    };
    let plain = torque("");
    assert!(torque("rolling_factor = 1.3") > plain + 50.0);
    assert!(torque("headwind_mps = 4.0") > plain + 50.0);
    assert!((torque("pto_nm = 100.0") - plain - 100.0).abs() < 30.0);
}

#[test]
fn a_retarder_is_reported_and_keeps_the_speed() {
    let road =
        "[road]\nlength_m = 8000.0\ngrade_sigma_percent = 4.0\nlargest_grade_percent = 6.0\n";
    let section = "[[runs.sections]]\nfrom_m = 0.0\nto_m = 8000.0\nretarder = true\n";
    let run = run(&[
        QUIET,
        road,
        "[[runs]]\nname = \"b\"\ntruck = \"B\"\n",
        section,
    ]);
    let reported = series(&run, Signal::RetarderTorque);
    assert!(reported.iter().any(|reading| reading.1 < -5.0));
    let speeds = series(&run, Signal::WheelSpeed);
    assert!(speeds.iter().all(|speed| speed.1 < 89.0 / 3.6));
}

#[test]
fn a_drive_may_last_more_than_a_day() {
    let text = "[[runs.stops]]\nat_m = 2000.0\nseconds = 90000.0\n";
    let scenario = scenario(&[QUIET, MILD, A, text]);
    let recording = Recording::new(&scenario, 0).unwrap();
    let drive = recording.drive();
    assert!(drive.duration_s() > 90_000.0, "{} s", drive.duration_s());
    let gigabytes = 1e-9 * size_of_val(&drive.states[..]) as f64;
    assert!(gigabytes < 1.5, "{gigabytes} GB");
}

#[test]
fn impossible_manoeuvres_are_refused_by_key() {
    for (text, expected) in [
        ("[[runs.stops]]\nseconds = 5.0\n", "at_m"),
        (
            "[[runs.stops]]\nat_m = 5.0\nseconds = 0.0\n",
            "runs[0].stops[0].seconds = 0",
        ),
        (
            "[[runs.stops]]\nat_m = 50.0\n[[runs.stops]]\nat_m = 40.0\n",
            "runs[0].stops[1].at_m = 40",
        ),
        (
            "[[runs.sections]]\nfrom_m = 5.0\nto_m = 4.0\n",
            "runs[0].sections[0].to_m = 4",
        ),
        (
            "[[runs.sections]]\nfrom_m = 5.0\nto_m = 9.0\npto = 4.0\n",
            "unknown field `pto`",
        ),
    ] {
        let error = key_error(text);
        assert!(error.contains(expected), "{error}");
    }
}
