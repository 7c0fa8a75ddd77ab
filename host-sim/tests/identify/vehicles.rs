//! The vehicle files that logs ask for, and how good estimates with them are.

use super::trucks::{
    HEAVY, LIGHT, QUICK, Truck, simulate, with_tachograph, without, without_ratio,
};
use embedded_can::{Frame, Id};
use estimator_core::Traction;
use host_sim::files::run;
use host_sim::files::truth;
use host_sim::files::vehicle::VehicleFile;
use host_sim::score::score_run;
use host_sim::source::can_frame::CanFrame;
use serde_json::Value;
use std::fmt::Write as _;
use std::fs;
use std::path::Path;
use test_kit::command::{folder, roadgrade};

pub fn identify(folder: &Path, out: &str, arguments: &[&str]) -> Vec<Value> {
    let mut all = vec!["identify", "--json", "--out", out];
    all.extend(arguments);
    let done = roadgrade(folder, &all).success();
    serde_json::from_slice(&done.get_output().stdout).unwrap()
}

fn value<'a>(values: &'a [Value], key: &str) -> &'a Value {
    values
        .iter()
        .find(|of| of["key"] == key)
        .unwrap_or_else(|| panic!("{key}"))
}

/// Engine turns to a metre in each gear, rad/m.
fn turns_per_m(file: &VehicleFile) -> Vec<f32> {
    let vehicle = &file.model.vehicle;
    let Traction::Powertrain(powertrain) = &vehicle.traction else {
        panic!("no powertrain");
    };
    let per_ratio = powertrain.final_drive_ratio / vehicle.wheel_radius_m;
    powertrain
        .gears
        .iter()
        .map(|gear| gear.ratio * per_ratio)
        .collect()
}

/// RMSE (%) and normalised squared error of the smoothed grade, and of the live one from a distance on.
pub fn scores(
    folder: &Path,
    vehicle: &str,
    log: &str,
    truth_of: &str,
    live_from_m: f64,
) -> [(f64, f64); 2] {
    let arguments = ["estimate", "--vehicle", vehicle, "--out", "run.csv", log];
    roadgrade(folder, &arguments).success();
    let rows = run::read(&folder.join("run.csv")).unwrap();
    let truth = truth::read(&folder.join(format!("{truth_of}.truth.csv"))).unwrap();
    [("smoothed", 0.0), ("live", live_from_m)].map(|(estimate, from_m)| {
        let first = rows.partition_point(|row| row.distance_m < from_m);
        let scored = score_run("run", &rows[first..], &truth).unwrap().rows;
        let row = scored.iter().find(|row| row.estimate == estimate).unwrap();
        (row.rmse_percent, row.nees)
    })
}

#[test]
fn estimates_with_the_identified_file_are_as_good_as_with_the_right_one() {
    let folder = folder();
    let path = folder.path();
    simulate(path, &[&HEAVY, &LIGHT], 25_000.0, false);
    for truck in [&HEAVY, &LIGHT] {
        let name = truck.name;
        let log = format!("{name}.log");
        // The bus with everything, without the mass (CVW), and without mass, EC1's transport and
        // the gearbox.
        let bare = ["FE70", "ECFF", "EBFF", "F005"];
        for (number, left_out) in [&[][..], &bare[..1], &bare].into_iter().enumerate() {
            let part = format!("{name}{number}.log");
            without(path, &log, &part, left_out);
            let values = identify(path, "found.toml", &[&part]);
            assert!(values.iter().all(|of| of["sigma"].as_f64().unwrap() >= 0.0));
            let right = scores(path, &format!("{name}.vehicle.toml"), &part, name, 0.0);
            let found = scores(path, "found.toml", &part, name, 0.0);
            let words = format!("{part}: {right:?}, {found:?}");
            assert!(found[0].0 <= 1.2 * right[0].0, "{words}");
            assert!(found[1].0 <= 1.3 * right[1].0, "{words}");
            // Of one drive of 25 km, not of many.
            assert!(
                found.iter().all(|of| (0.1..=2.5).contains(&of.1)),
                "{words}"
            );
        }
    }
}

#[test]
fn the_gears_of_a_launch_are_found_on_a_bus_that_reports_no_ratio() {
    let folder = folder();
    let path = folder.path();
    simulate(path, &[&QUICK], 12_000.0, false);
    let left_out = ["FE70", "ECFF", "EBFF", "FDC4", "F005"];
    without(path, "quick.log", "no_gear.log", &left_out);
    without(path, "quick.log", "part.log", &left_out[..4]);
    without_ratio(path, "part.log", "no_ratio.log");
    for log in ["no_gear.log", "no_ratio.log"] {
        identify(path, "found.toml", &[log]);
        let file = |name: &str| turns_per_m(&VehicleFile::read(&path.join(name)).unwrap());
        let (right, found) = (file("quick.toml"), file("found.toml"));
        assert!(found.len() >= 4, "{log}: {found:?} of {right:?}");
        for ratio in &found {
            let off = |right: &f32| (ratio / right - 1.0).abs();
            assert!(
                right.iter().any(|right| off(right) < 0.01),
                "{log}: {ratio} is none of {right:?}"
            );
        }
        // Without them, the slopes of the launch were off by several percent.
        let of = |vehicle: &str| scores(path, vehicle, log, "quick", 0.0);
        let (right, found) = (of("quick.vehicle.toml"), of("found.toml"));
        assert!(
            found[0].0 <= 1.2 * right[0].0,
            "{log}: {right:?}, {found:?}"
        );
    }
}

fn check_read(truck: &Truck) {
    let folder = folder();
    let path = folder.path();
    simulate(path, &[truck], 12_000.0, false);
    let log = format!("{}.log", truck.name);
    let values = identify(path, "found.toml", &[&log]);
    let torque = value(&values, "powertrain.reference_torque_nm");
    assert_eq!(torque["value"], f64::from(truck.reference_torque_nm));
    assert_eq!(torque["origin"], "read");
    assert_eq!(value(&values, "vehicle.mass_kg")["origin"], "read");
    assert_eq!(
        value(&values, "vehicle.wheel_inertia_kgm2")["origin"],
        "assumed"
    );
    let right = VehicleFile::read(&path.join(format!("{}.toml", truck.name))).unwrap();
    let found = VehicleFile::read(&path.join("found.toml")).unwrap();
    let (right, found) = (turns_per_m(&right), turns_per_m(&found));
    // Started from standstill: all gears but some that a start may skip.
    assert_eq!(found.len(), right.len(), "{found:?}, {right:?}");
    for (number, (found, right)) in found.iter().zip(&right).enumerate() {
        let of = value(&values, &format!("powertrain.gears[{number}].ratio"));
        if of["origin"] != "assumed" {
            let off = found / right - 1.0;
            assert!(off.abs() < 0.01, "gear {number}: {found} for {right}");
        }
    }
}

#[test]
fn what_the_bus_tells_is_read_exactly() {
    check_read(&HEAVY);
    check_read(&LIGHT);
}

#[test]
fn each_value_of_the_file_has_a_comment_that_tells_its_origin() {
    let folder = folder();
    let path = folder.path();
    simulate(path, &[&LIGHT], 8_000.0, false);
    let values = identify(path, "found.toml", &["light.log"]);
    let text = fs::read_to_string(path.join("found.toml")).unwrap();
    let commented = text
        .lines()
        .filter(|line| !line.starts_with('#') && line.contains(" = ") && !line.starts_with("name"))
        .inspect(|line| {
            let words = ["# read", "# measured ± ", "# assumed ± "];
            assert!(words.iter().any(|word| line.contains(word)), "{line}");
        })
        .count();
    assert_eq!(commented, values.len());
    let keys: Vec<&str> = values
        .iter()
        .map(|of| of["key"].as_str().unwrap())
        .collect();
    assert!(
        keys.contains(&"vehicle.drag_area_m2") && keys.contains(&"powertrain.final_drive_ratio")
    );
}

#[test]
fn the_speed_of_the_tachograph_is_enough() {
    let folder = folder();
    let path = folder.path();
    simulate(path, &[&HEAVY], 20_000.0, false);
    with_tachograph(path, "heavy.log", "tachograph.log");
    let of = |log: &str| identify(path, "found.toml", &[log]);
    let (wheels, tachograph) = (of("heavy.log"), of("tachograph.log"));
    for key in ["vehicle.mass_kg", "vehicle.drag_area_m2"] {
        let [expected, found] =
            [&wheels, &tachograph].map(|values| value(values, key)["value"].as_f64().unwrap());
        assert!(
            (found / expected - 1.0).abs() < 0.05,
            "{key}: {found}, {expected}"
        );
    }
}

#[test]
fn two_logs_narrow_what_one_tells() {
    let folder = folder();
    let path = folder.path();
    simulate(path, &[&LIGHT], 20_000.0, true);
    let sigma = |logs: &[&str]| {
        let values = identify(path, "found.toml", logs);
        value(&values, "vehicle.drag_area_m2")["sigma"]
            .as_f64()
            .unwrap()
    };
    let (one, two) = (
        sigma(&["light.log"]),
        sigma(&["light.log", "light_back.log"]),
    );
    assert!(two < one, "{two} with two logs, {one} with one");
}

#[test]
fn a_vehicle_file_as_a_model_gives_what_is_not_measured() {
    let folder = folder();
    let path = folder.path();
    simulate(path, &[&LIGHT], 5_000.0, false);
    let values = identify(path, "found.toml", &["--like", "light.toml", "light.log"]);
    let inertia = value(&values, "vehicle.wheel_inertia_kgm2");
    assert_eq!(
        (&inertia["value"], &inertia["origin"]),
        (&60.0.into(), &"assumed".into())
    );
    // Radius and final drive together are what the speeds show.
    let radius = value(&values, "vehicle.wheel_radius_m")["value"]
        .as_f64()
        .unwrap();
    assert!((radius / 0.42 - 1.0).abs() < 0.005, "{radius}");
}

#[test]
fn logs_of_two_vehicles_are_refused() {
    let folder = folder();
    let path = folder.path();
    simulate(path, &[&HEAVY, &LIGHT], 4_000.0, false);
    let run = |arguments: &[&str]| {
        let command = [&["identify", "--out", "found.toml"][..], arguments].concat();
        roadgrade(path, &command)
    };
    let refused = run(&["heavy.log", "light.log"]).failure().code(1);
    let told = String::from_utf8_lossy(&refused.get_output().stderr).into_owned();
    for part in [
        "of another vehicle than",
        "heavy.log",
        "light.log",
        "reference torque",
        "--like",
    ] {
        assert!(told.contains(part), "{part}: {told}");
    }
    assert!(!path.join("found.toml").exists());
    run(&["light.log", "light.log"]).success();
    // Who says what the vehicle is like, knows what it is.
    run(&["--like", "truck12t", "heavy.log", "light.log"]).success();
}

#[test]
fn logs_with_two_identification_numbers_are_refused() {
    let folder = folder();
    let path = folder.path();
    simulate(path, &[&HEAVY], 4_000.0, false);
    let log = fs::read_to_string(path.join("heavy.log")).unwrap();
    let (_, first) = log.split_once('(').unwrap();
    let (time, rest) = first.split_once(')').unwrap();
    let bus = rest.split_whitespace().next().unwrap();
    let numbered = |name: &str, number: &str| {
        let frames = CanFrame::broadcast(65_260, 0, number.as_bytes());
        let mut text = String::new();
        for frame in frames {
            let id = match frame.id() {
                Id::Extended(id) => id.as_raw(),
                Id::Standard(_) => panic!("29 bits"),
            };
            let data: String = frame.data().iter().map(|b| format!("{b:02X}")).collect();
            writeln!(text, "({time}) {bus} {id:08X}#{data}").unwrap();
        }
        fs::write(path.join(name), text + &log).unwrap();
    };
    let numbers = ["1XKYD49X0EJ123456", "1XKYD49X0EJ123457"];
    numbered("a.log", numbers[0]);
    numbered("b.log", numbers[1]);
    let identify = |logs: &[&str]| {
        let command = [&["identify", "--out", "found.toml"][..], logs].concat();
        roadgrade(path, &command)
    };
    let refused = identify(&["a.log", "heavy.log", "b.log"]).failure().code(1);
    let told = String::from_utf8_lossy(&refused.get_output().stderr).into_owned();
    for part in [
        "b.log",
        "of another vehicle than",
        "a.log",
        numbers[0],
        numbers[1],
    ] {
        assert!(told.contains(part), "{part}: {told}");
    }
    identify(&["a.log", "heavy.log"]).success();
}

#[test]
fn a_receiver_that_is_late_is_told() {
    let folder = folder();
    let path = folder.path();
    simulate(path, &[&HEAVY], 25_000.0, false);
    let told = |log: &str| {
        let arguments = ["identify", "--out", "found.toml", log];
        let done = roadgrade(path, &arguments).success();
        let errors = String::from_utf8(done.get_output().stderr.clone()).unwrap();
        let file = fs::read_to_string(path.join("found.toml")).unwrap();
        VehicleFile::read(&path.join("found.toml")).unwrap();
        [errors, file].map(|text| {
            let late = text.lines().find(|line| line.contains("s late:"));
            late.map(str::to_owned)
        })
    };
    assert_eq!(told("heavy.log"), [None, None]);
    let scenario = fs::read_to_string(path.join("scenario.toml")).unwrap();
    let late = scenario.replace("[road]", "[latency_ms]\ngnss = 1200.0\n[road]");
    fs::write(path.join("scenario.toml"), late).unwrap();
    roadgrade(
        path,
        &["simulate", "--scenario", "scenario.toml", "--out", "late"],
    )
    .success();
    for told in told("late/heavy.log") {
        let told = told.unwrap();
        // Behind a wheel speed that is 0.03 s late.
        let seconds = told.split("receiver is ").nth(1).unwrap();
        let seconds: f64 = seconds.split(' ').next().unwrap().parse().unwrap();
        assert!((seconds - 1.17).abs() < 0.06, "{told}");
    }
}
