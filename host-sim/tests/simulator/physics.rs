//! The simulated world has the physics of the thesis, on a plausible road.

use estimator_core::Signal;
use host_sim::simulator::Recording;
use host_sim::simulator::drive::STEP_S;
use host_sim::simulator::road_generator::{RoadShape, generate};
use host_sim::simulator::scenario::Scenario;
use std::path::Path;
use test_kit::simulated::{A, B, MILD, run, scenario, series};

#[test]
fn integrating_the_force_balance_gives_the_altitude_back() {
    // With shifts and brakes: the steep default road, truck A.
    let scenario = scenario(&["seed = 2\n", "[road]\nlength_m = 20000.0\n", A]);
    let recording = Recording::new(&scenario, 0).unwrap();
    let drive = recording.drive();
    let (mut shifts, mut braked) = (0, 0);
    let mut altitude_m = drive.road.altitude_m(0.0);
    let mut worst_m = 0.0_f64;
    for state in &drive.states {
        worst_m = worst_m.max((altitude_m - drive.road.altitude_m(state.distance_m)).abs());
        let drag_n = 0.5 * 6.0 * scenario.runs[0].air.density() * state.speed_mps.powi(2);
        let rolling_n = 39_000.0 * 9.806_65 * f64::from(0.0065_f32);
        let inertia_n = state.accelerated_kg * state.acceleration_mps2;
        let climbing_n = state.traction_n - drag_n - rolling_n - state.brake_n - inertia_n;
        let driven_m = STEP_S * (state.speed_mps + 0.5 * STEP_S * state.acceleration_mps2);
        altitude_m += climbing_n / (39_000.0 * 9.806_65) * driven_m;
        shifts += u32::from(state.shifting);
        braked += u32::from(state.braking());
    }
    assert!(shifts > 0 && braked > 0, "the drive must exercise both");
    assert!(worst_m < 0.01, "{worst_m} m");
}

#[test]
fn cruise_control_keeps_the_speed_on_a_mild_road() {
    for truck in [A, B] {
        let text = MILD.replace("5000", "20000");
        let run = run(&[&text, truck]);
        for (_, speed_mps) in series(&run, Signal::WheelSpeed) {
            assert!((60.0..90.0).contains(&(3.6 * speed_mps)), "{speed_mps}");
        }
    }
}

#[test]
fn reported_brakes_and_shifts_are_the_true_ones() {
    let run = run(&["seed = 2\n", "[road]\nlength_m = 20000.0\n", A]);
    let truth = |time_s: f64| run.truth[((10.0 * time_s) as usize).min(run.truth.len() - 1)];
    let fastest = series(&run, Signal::WheelSpeed)
        .iter()
        .fold(0.0_f32, |fastest, s| fastest.max(s.1));
    assert!((89.0..90.0).contains(&(3.6 * fastest)), "{fastest}");
    // Within the truth's step and the latency.
    let near = |time_s: f64| [-0.1, 0.0, 0.1].map(|away| truth(time_s + away));
    let mut braked = 0;
    for (time_s, on) in series(&run, Signal::BrakeSwitch) {
        if on > 0.5 {
            assert!(near(time_s).iter().any(|row| row.braking == 1), "{time_s}");
            braked += 1;
        }
    }
    let mut shifting = 0;
    for (time_s, on) in series(&run, Signal::ShiftInProcess) {
        if on > 0.5 {
            assert!(near(time_s).iter().any(|row| row.shifting == 1), "{time_s}");
            shifting += 1;
        }
    }
    assert!(braked > 10 && shifting > 100, "{braked} {shifting}");

    // Each shift takes 0.8 to 1.2 s. The reported gear changes only when it is over.
    let ends = run
        .truth
        .windows(2)
        .filter(|w| w[0].shifting > w[1].shifting);
    let ends: Vec<f64> = ends.map(|w| w[1].time_s).collect();
    let starts = run
        .truth
        .windows(2)
        .filter(|w| w[0].shifting < w[1].shifting);
    for (from, to) in starts.map(|w| w[1].time_s).zip(&ends) {
        assert!((0.65..1.35).contains(&(to - from)), "{from} {to}");
    }
    let gears = series(&run, Signal::CurrentGear);
    let changes: Vec<f64> = gears
        .windows(2)
        .filter(|w| w[0].1 != w[1].1)
        .map(|w| w[1].0)
        .collect();
    assert_eq!(changes.len(), ends.len());
    for (change, end) in changes.iter().zip(&ends) {
        assert!((-0.1..0.25).contains(&(change - end)), "{change} {end}");
    }
}

#[test]
fn a_truck_moves_off_from_standstill() {
    for truck in [A, B] {
        let text = format!("{MILD}{truck}start = \"standstill\"\n");
        let run = run(&[&text]);
        let speeds = series(&run, Signal::WheelSpeed);
        assert!(speeds[..40].iter().all(|s| s.1 == 0.0));
        assert_eq!(series(&run, Signal::ParkingBrake)[0].1, 1.0);
        assert_eq!((run.truth[10].braking, run.truth[10].distance_m), (1, 0.0));
        assert!(speeds.iter().all(|s| s.1 >= 0.0));
        let reached = speeds.iter().find(|s| s.1 > 79.0 / 3.6).expect("80 km/h");
        assert!((20.0..150.0).contains(&reached.0), "{reached:?}");
    }
}

#[test]
fn generated_roads_could_have_been_built() {
    for seed in 0..20 {
        let shape = RoadShape::default();
        let road = generate(&shape, seed);
        let nodes: Vec<_> = road.nodes().collect();
        assert!((road.length_m() - shape.length_m).abs() < 1e-6);
        for pair in nodes.windows(2) {
            let [(from, low), (to, high)] = [pair[0], pair[1]];
            let driven_m = to.distance_m - from.distance_m;
            let change = 100.0 * (to.grade - from.grade).abs() / driven_m;
            assert!(change <= shape.largest_change_percent_per_m * (1.0 + 1e-9));
            // Altitude is the integral of the sine of the slope.
            let steps = 1000;
            let climbed: f64 = (0..steps)
                .map(|k| {
                    let part = (f64::from(k) + 0.5) / f64::from(steps);
                    let grade = from.grade + part * (to.grade - from.grade);
                    grade.atan().sin() * driven_m / f64::from(steps)
                })
                .sum();
            assert!((high - low - climbed).abs() < 1e-7);
        }
        let grades = nodes.iter().map(|node| (100.0 * node.0.grade).abs());
        assert!(
            grades
                .clone()
                .all(|grade| grade <= shape.largest_grade_percent)
        );
        let mild = grades.filter(|grade| *grade <= 3.0).count();
        assert!(mild as f64 > 0.85 * nodes.len() as f64, "mostly within 3 %");
        let altitudes = nodes.iter().map(|node| node.1 - shape.start_altitude_m);
        assert!(altitudes.into_iter().all(|height| height.abs() < 150.0));
        let tightest = (0..4000)
            .map(|k| road.curvature_per_m(10.0 * f64::from(k)).abs())
            .fold(0.0, f64::max);
        assert!(tightest <= 1.01 / shape.smallest_radius_m && tightest > 1e-4);
    }
}

#[test]
fn a_road_is_the_same_from_its_end() {
    let road = generate(&RoadShape::default(), 5);
    let back = road.reversed();
    for k in 0..1000 {
        let there = 39.9 * f64::from(k);
        let here = road.length_m() - there;
        assert!((road.grade(here) + back.grade(there)).abs() < 1e-12);
        assert!((road.altitude_m(here) - back.altitude_m(there)).abs() < 1e-6);
        assert!((road.curvature_per_m(here) + back.curvature_per_m(there)).abs() < 1e-12);
        let turn = road.course_rad(here) - back.course_rad(there);
        assert!((turn.abs() - std::f64::consts::PI).abs() < 1e-9);
    }
}

#[test]
fn the_built_in_scenarios_are_sound() {
    let builtin = Scenario::builtin();
    let trucks: Vec<&str> = builtin
        .runs
        .iter()
        .map(|run| run.vehicle.name.as_str())
        .collect();
    assert_eq!(trucks, ["A", "A", "A", "B", "B"]);
    for run in &builtin.runs {
        assert_ne!(run.true_parameters, run.vehicle.model.vehicle);
    }
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenarios/motorway.toml");
    let motorway = Scenario::read(&file).unwrap();
    assert_eq!(motorway.road.length_m(), 40_000.0);
    for run in &motorway.runs {
        assert_eq!(run.true_parameters, run.vehicle.model.vehicle);
    }
}

#[test]
fn every_key_of_the_documentation_is_a_key() {
    // The example in the documentation of scenario_file.
    let source = include_str!("../../src/simulator/scenario_file.rs");
    let example: String = source
        .split("//! ```")
        .nth(1)
        .unwrap()
        .lines()
        .skip(1)
        .map(|line| format!("{}\n", line.trim_start_matches("//!")))
        .collect();
    let documented = Scenario::parse(&example, Path::new("documentation")).unwrap();
    let plain = scenario(&["[[runs]]\nname = \"a1\"\ntruck = \"A\"\n"]);
    // Its values are the defaults.
    assert_eq!(
        format!("{:?}", documented.noise),
        format!("{:?}", plain.noise)
    );
    assert_eq!(
        format!("{:?}", documented.gnss),
        format!("{:?}", plain.gnss)
    );
    assert_eq!(
        format!("{:?}", documented.latency_ms),
        format!("{:?}", plain.latency_ms)
    );
    assert_eq!(
        format!("{:?}", documented.rates),
        format!("{:?}", plain.rates)
    );
    assert_eq!(
        format!("{:?}", documented.runs[0].air),
        format!("{:?}", plain.runs[0].air)
    );
    assert_eq!(
        documented.runs[0].true_parameters,
        plain.runs[0].true_parameters
    );
    assert!(documented.road.nodes().eq(plain.road.nodes()));
}
