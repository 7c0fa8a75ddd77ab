//! Planted effects act according to their formulas, and nothing is planted by default.

use estimator_core::Signal;
use host_sim::simulator::drive::{DriveState, STEP_S};
use host_sim::simulator::scenario::Scenario;
use host_sim::simulator::{Recording, SimulatedRun, simulate};
use std::collections::BTreeMap;
use std::path::Path;
use test_kit::simulated::{A, B, MILD, QUIET, run, scenario, series};

/// Weight of truck A, N.
const WEIGHT_N: f64 = 39_000.0 * 9.806_65;
/// Efficiency of its top gear with the final drive.
const EFFICIENCY: f64 = 0.995_f32 as f64 * 0.98_f32 as f64;
const CURVY: &str = "[road]\nlength_m = 5000.0\ngrade_sigma_percent = 0.5\n\
    largest_grade_percent = 1.0\nsmallest_radius_m = 300.0\nlargest_radius_m = 600.0\n";

fn unmodelled(scenario: &Scenario) -> Vec<(DriveState, f64)> {
    let recording = Recording::new(scenario, 0).unwrap();
    let states = recording.drive().states.clone();
    let percents = recording.unmodelled().map(|step| step.percent);
    states.into_iter().zip(percents).collect()
}

fn planted(text: &str) -> Vec<(DriveState, f64)> {
    unmodelled(&scenario(&[
        "seed = 2\n",
        MILD,
        "[planted]\n",
        text,
        "\n",
        A,
    ]))
}

#[test]
fn nothing_is_planted_by_default() {
    let none = "[planted]\ncornering_compliance_rad = 0.0\ndriveline_loss = 0.0\n\
        auxiliary_w = 0.0\nfan_w = 0.0\nfan_period_s = 10.0\nbrake_drag_n = 0.0\n\
        wheel_radius_factor = 1.0\ntyre_temperature_per_k = 0.0\nrough = []\nside_resistance = []\n\
        torque_hysteresis = 0.0\nthermostat_w = 0.0\nthermostat_period_s = 10.0\n";
    for start in ["", "start = \"standstill\"\n"] {
        let with = |table: &str| {
            scenario(&[
                "seed = 2\n",
                table,
                "[road]\nlength_m = 20000.0\n",
                A,
                start,
            ])
        };
        // The model explains everything, also with shifts, brakes and a launch.
        let plain = with("");
        let recording = Recording::new(&plain, 0).unwrap();
        let states = &recording.drive().states;
        assert!(states.iter().any(|s| s.shifting) && states.iter().any(DriveState::braking));
        for step in recording.unmodelled().filter(|step| step.length_m > 0.0) {
            assert!(step.percent.abs() < 1e-9, "{step:?}");
        }
        // A missing key has the same meaning as its value for no effect.
        let (left_out, written) = (
            simulate(&plain, 0).unwrap(),
            simulate(&with(none), 0).unwrap(),
        );
        assert!(left_out.frames == written.frames && left_out.truth == written.truth);
    }
}

#[test]
fn each_force_is_that_of_its_formula() {
    let expect = |text: &str, force_n: &dyn Fn(&DriveState) -> f64| {
        let states = planted(text);
        assert!(states.iter().all(|(state, _)| state.gear == 12));
        for (state, percent) in states {
            let expected = 100.0 * force_n(&state) / WEIGHT_N;
            assert!(
                (percent - expected).abs() < 1e-6,
                "{text}: {percent}, not {expected}"
            );
        }
    };
    expect("brake_drag_n = 400.0", &|_| 400.0);
    // The air has 20 °C.
    let rolling_n = f64::from(0.0065_f32) * WEIGHT_N;
    expect("tyre_temperature_per_k = 0.01", &|_| 0.05 * rolling_n);
    expect("driveline_loss = 0.05", &|s| 0.05 * s.traction_n.abs());
    expect("auxiliary_w = 8000.0", &|s| {
        8000.0 * EFFICIENCY / s.speed_mps
    });
    expect("fan_w = 20000.0", &|s| {
        0.01 * s.fan_percent * 20_000.0 * EFFICIENCY / s.speed_mps
    });
    let within = |from_m: f64, to_m: f64, s: &DriveState| {
        // The forces are those half a step ahead.
        let ahead_m = s.distance_m + 0.5 * STEP_S * s.speed_mps;
        f64::from(u8::from((from_m..to_m).contains(&ahead_m)))
    };
    for key in ["rough", "side_resistance"] {
        expect(
            &format!("{key} = [[1000.0, 2000.0, 0.002], [1500.0, 3000.0, 0.001]]"),
            &|s| WEIGHT_N * (0.002 * within(1000.0, 2000.0, s) + 0.001 * within(1500.0, 3000.0, s)),
        );
    }
}

#[test]
fn tyres_resist_where_the_bus_reports_yaw() {
    let parts = [
        QUIET,
        "[planted]\ncornering_compliance_rad = 0.18\n",
        CURVY,
        A,
    ];
    let scenario = scenario(&parts);
    let run = simulate(&scenario, 0).unwrap();
    let recording = Recording::new(&scenario, 0).unwrap();
    let percents: Vec<f64> = recording.unmodelled().map(|step| step.percent).collect();
    let start_s = 1e-6 * run.frames[0].time.micros() as f64;
    let (mut largest, mut compared) = (0.0_f64, 0);
    for (time_s, yaw) in series(&run, Signal::YawRate) {
        let step = ((start_s + time_s) / STEP_S) as usize;
        let lateral = recording.drive().states[step].speed_mps * f64::from(yaw) / 9.806_65;
        let expected = 100.0 * 0.18 * lateral * lateral;
        // Tolerance: the rounding of the yaw rate, and a step.
        assert!(
            (percents[step] - expected).abs() < 0.003 + 0.01 * expected,
            "{expected} {}",
            percents[step]
        );
        largest = largest.max(expected);
        compared += 1;
    }
    assert!(compared > 1000 && largest > 0.1, "{largest}");
}

#[test]
fn curvy_roads_have_the_requested_radii() {
    let text = CURVY.replace("5000", "20000");
    let road = &scenario(&[&text, A]).road;
    let tightest = (0..2000)
        .map(|k| road.curvature_per_m(10.0 * f64::from(k)).abs())
        .fold(0.0, f64::max);
    assert!((1.0 / 330.0..=1.01 / 300.0).contains(&tightest));
    // The road does not wind in circles.
    let straight_m = |from: f64, to: f64| {
        let (from, to) = (road.position(from), road.position(to));
        let north = (to.latitude_deg - from.latitude_deg) * 111_200.0;
        let east = (to.longitude_deg - from.longitude_deg) * 111_200.0 * 0.513;
        north.hypot(east)
    };
    for km in 0..17 {
        let from_m = 1000.0 * f64::from(km);
        assert!(straight_m(from_m, from_m + 3000.0) > 1000.0);
    }
}

/// Returns the reported work of the engine through the top gear over the distance, N.
fn reported_force_n(run: &SimulatedRun) -> f64 {
    let friction = series(run, Signal::FrictionTorque);
    let fraction = series(run, Signal::EngineTorqueFraction);
    let speeds = series(run, Signal::WheelSpeed);
    let at = |series: &[(f64, f32)], time_s: f64| {
        let after = series.partition_point(|s| s.0 <= time_s);
        f64::from(series[after.saturating_sub(1)].1)
    };
    let (mut work, mut driven_m) = (0.0, 0.0);
    for (time_s, torque) in series(run, Signal::EngineTorque) {
        let percent = f64::from(torque) + at(&fraction, time_s) - at(&friction, time_s);
        let speed_mps = at(&speeds, time_s);
        work += 0.01 * percent * 1750.0 * f64::from(2.92_f32) * EFFICIENCY / 0.5 * speed_mps;
        driven_m += speed_mps;
    }
    work / driven_m
}

#[test]
fn the_engine_works_against_what_is_planted() {
    let with = |text: &str| scenario(&["seed = 2\n", text, QUIET, MILD, A]);
    let clean = reported_force_n(&simulate(&with(""), 0).unwrap());
    for text in [
        "[planted]\nbrake_drag_n = 400.0\n",
        "[planted]\ndriveline_loss = 0.1\n",
        "[planted]\nauxiliary_w = 9000.0\n",
        "[planted]\nfan_w = 20000.0\nfan_period_s = 30.0\n",
        "[planted]\nthermostat_w = 20000.0\nthermostat_period_s = 30.0\n",
        "[planted]\nrough = [[1000.0, 3000.0, 0.002]]\n",
        "[planted]\nside_resistance = [[1000.0, 3000.0, 0.002]]\n",
        "[wind]\nspeed_mps = 3.0\nfrom_deg = 225.0\n",
        "[tyres]\ncold_amount = 0.3\n",
    ] {
        let scenario = with(text);
        let run = simulate(&scenario, 0).unwrap();
        let recording = Recording::new(&scenario, 0).unwrap();
        let (sum, driven_m) = recording.unmodelled().fold((0.0, 0.0), |sum, step| {
            (sum.0 + step.length_m * step.percent, sum.1 + step.length_m)
        });
        let mean = sum / driven_m;
        let reported = 100.0 * (reported_force_n(&run) - clean) / WEIGHT_N;
        assert!(mean > 0.04, "{text}: {mean}");
        // Torque has steps of 1/8 %, which is 0.003 % grade. The final speeds differ a little.
        assert!(
            (reported - mean).abs() < 0.006,
            "{text}: {reported}, not {mean}"
        );
        // The driver holds the speed nevertheless.
        let last = recording.drive().states.last().unwrap().speed_mps;
        assert!((3.6 * last - 80.0).abs() < 2.0, "{text}: {last}");
    }
}

#[test]
fn a_fan_is_reported_and_switches_irregularly() {
    let text = MILD.replace("5000", "100000");
    let run = run(&[
        "[planted]\nfan_w = 20000.0\nfan_period_s = 60.0\n",
        &text,
        A,
    ]);
    let reported = series(&run, Signal::Fan);
    assert!(reported.iter().all(|s| s.1 == 0.0 || s.1 == 100.0));
    let share = reported.iter().filter(|s| s.1 > 0.0).count() as f64 / reported.len() as f64;
    assert!((0.33..0.47).contains(&share), "{share}");
    let on: Vec<f64> = reported
        .windows(2)
        .filter(|w| w[0].1 < w[1].1)
        .map(|w| w[1].0)
        .collect();
    let periods: Vec<f64> = on.windows(2).map(|w| w[1] - w[0]).collect();
    let mean = periods.iter().sum::<f64>() / periods.len() as f64;
    let spread = periods.iter().map(|p| (p - mean).powi(2)).sum::<f64>() / periods.len() as f64;
    assert!((50.0..70.0).contains(&mean), "{mean}");
    assert!(spread.sqrt() > 8.0, "{}", spread.sqrt());
}

#[test]
fn a_thermostat_cycles_with_the_clock_and_is_not_reported() {
    let text = "[planted]\nthermostat_w = 20000.0\nthermostat_period_s = 40.0\n";
    let start = "start_time_s = 1010.0\n";
    let loud = scenario(&[text, QUIET, MILD, A, start]);
    for (step, (_, percent)) in unmodelled(&loud).into_iter().enumerate() {
        let phase = (1010.0 + STEP_S * (step + 1) as f64).rem_euclid(40.0);
        if phase.rem_euclid(20.0) > 0.02 {
            assert_eq!(percent > 0.1, phase < 20.0, "{phase}: {percent}");
        }
    }
    let run = simulate(&loud, 0).unwrap();
    assert!(series(&run, Signal::Fan).iter().all(|s| s.1 == 0.0));
    assert!(series(&run, Signal::ParasiticTorque).is_empty());
}

#[test]
fn torque_lags_by_its_play() {
    let states = planted("torque_hysteresis = 2.0");
    let play_n = 0.02 * 1750.0 * f64::from(2.92_f32) * EFFICIENCY / 0.5;
    let (mut rising, mut falling) = (0, 0);
    let mut turned_nm = states[0].0.net_torque_nm;
    let mut before = states[0].0;
    for (state, percent) in &states {
        let lost_n = 0.01 * percent * WEIGHT_N;
        assert!(lost_n.abs() < play_n + 1e-3, "{lost_n}");
        let shifted_nm = state.net_torque_nm - before.net_torque_nm;
        if shifted_nm * (before.net_torque_nm - turned_nm) < 0.0 {
            turned_nm = before.net_torque_nm;
        }
        // After a change of twice the play since the turning point, torque lags by the play.
        let since_nm = state.net_torque_nm - turned_nm;
        if since_nm.abs() > 0.04 * 1750.0 {
            assert!((lost_n - play_n.copysign(since_nm)).abs() < 1e-3);
            if since_nm > 0.0 {
                rising += 1;
            } else {
                falling += 1;
            }
        }
        before = *state;
    }
    assert!(rising > 100 && falling > 100, "{rising} {falling}");
}

#[test]
fn wheels_of_another_radius_report_another_speed() {
    let text = "[planted]\nwheel_radius_factor = 0.97\n";
    let run = run(&[text, QUIET, MILD, A]);
    let gnss: BTreeMap<u64, f32> = series(&run, Signal::GnssSpeed)
        .into_iter()
        .map(|(time_s, mps)| ((10.0 * time_s) as u64, mps))
        .collect();
    let mut compared = 0;
    for (time_s, reported_mps) in series(&run, Signal::WheelSpeed) {
        if let Some(true_mps) = gnss.get(&((10.0 * time_s) as u64)) {
            // The times differ by up to a tenth of a second, and speed has steps of 0.01 m/s.
            assert!((reported_mps * 0.97 - true_mps).abs() < 0.03);
            compared += 1;
        }
    }
    assert!(compared > 500);
    // Shafts turn as the wheels do: speed and engine speed agree for the assumed radius.
    let rpm = series(&run, Signal::EngineSpeed)[1000].1;
    let near = series(&run, Signal::WheelSpeed)[100].1;
    assert!((near / 0.5 * 2.92 * 60.0 / std::f32::consts::TAU / rpm - 1.0).abs() < 2e-3);
}

#[test]
fn one_carriageway_is_driven_in_one_direction() {
    let rms = |key: &str, direction: &str| {
        let text = format!(
            "[planted]\n{key} = [[500.0, 1500.0, 0.004]]\n{MILD}{B}direction = \"{direction}\"\n"
        );
        let states = unmodelled(&scenario(&[&text]));
        let rough = |s: &&(DriveState, f64)| s.1 > 0.3;
        let places = states.iter().filter(rough).map(|s| s.0.distance_m);
        (
            places.clone().fold(f64::MAX, f64::min),
            places.fold(f64::MIN, f64::max),
        )
    };
    let near = |(from, to): (f64, f64), expected: (f64, f64)| {
        assert!((from - expected.0).abs() < 0.5 && (to - expected.1).abs() < 0.5);
    };
    near(rms("rough", "forward"), (500.0, 1500.0));
    near(rms("rough", "backward"), (3500.0, 4500.0));
    near(rms("side_resistance", "forward"), (500.0, 1500.0));
    let (from, to) = rms("side_resistance", "backward");
    assert!(from > to, "nowhere");
}

#[test]
fn runs_may_start_warm_and_on_another_day() {
    let text = format!(
        "[tyres]\ncold_amount = 0.5\ncold_time_s = 1000.0\n[wind]\nspeed_mps = 4.0\n\
         from_deg = 225.0\n{MILD}{A}wind = {{ speed_mps = 0.0, from_deg = 0.0 }}\n\
         tyres_driven_s = 2000.0\nstart_time_s = 40000.0\n"
    );
    let scenario = scenario(&[&text]);
    let (_, first) = unmodelled(&scenario)[0];
    let expected = 100.0 * f64::from(0.0065_f32) * 0.5 * (-2.0_f64).exp();
    assert!((first - expected).abs() < 1e-5, "{first}, not {expected}");
    let recording = Recording::new(&scenario, 0).unwrap();
    let noise = recording.oracle().noise;
    assert!((noise.cold_tyres.unwrap().amount - 0.5 * (-2.0_f64).exp()).abs() < 1e-9);
    assert!(noise.headwind.is_none());
    let first = recording.frames().next().unwrap();
    assert!((first.time.micros() as f64 * 1e-6 - 40_000.5).abs() < 0.1);
}

#[test]
fn runs_may_have_air_of_their_own_temperature() {
    let text = format!(
        "[planted]\ntyre_temperature_per_k = 0.01\n[air]\ntemperature_celsius = 15.0\n\
         {MILD}{A}\n[[runs]]\nname = \"cold\"\ntruck = \"A\"\ntemperature_celsius = -15.0\n"
    );
    let scenario = scenario(&[&text]);
    let density = |run: usize| scenario.runs[run].air.density();
    assert!((density(1) / density(0) - 288.15 / 258.15).abs() < 1e-9);
    // The model knows the density of the air, and lacks the resistance of the tyres.
    for (run, kelvin) in [(0, 10.0), (1, 40.0)] {
        let recording = Recording::new(&scenario, run).unwrap();
        let step = recording.unmodelled().next().unwrap();
        let expected = 100.0 * f64::from(0.0065_f32) * 0.01 * kelvin;
        assert!((step.percent - expected).abs() < 1e-5, "{step:?}");
    }
}

#[test]
fn bad_keys_are_refused_by_name() {
    let cases = [
        (
            "cornering_compliance_rad = -0.1",
            "planted.cornering_compliance_rad",
        ),
        ("driveline_loss = 0.6", "planted.driveline_loss"),
        ("auxiliary_w = nan", "planted.auxiliary_w"),
        ("fan_w = -1.0", "planted.fan_w"),
        ("fan_period_s = 0.0", "planted.fan_period_s"),
        ("brake_drag_n = inf", "planted.brake_drag_n"),
        ("wheel_radius_factor = 0.0", "planted.wheel_radius_factor"),
        (
            "tyre_temperature_per_k = 0.2",
            "planted.tyre_temperature_per_k",
        ),
        ("rough = [[-1.0, 5.0, 0.001]]", "planted.rough (start)"),
        ("rough = [[9.0, 5.0, 0.001]]", "planted.rough (end)"),
        (
            "side_resistance = [[1.0, 5.0, 0.1]]",
            "planted.side_resistance (rolling)",
        ),
        ("rough = [[1.0, 5.0]]", "rough"),
        ("torque_hysteresis = 51.0", "planted.torque_hysteresis"),
        ("thermostat_w = \"much\"", "thermostat_w"),
        ("thermostat_period_s = -5.0", "planted.thermostat_period_s"),
        ("cornering = 0.1", "cornering"),
    ];
    let refused = |text: &str, key: &str| {
        let message = Scenario::parse(text, Path::new("s.toml"))
            .expect_err(text)
            .to_string();
        assert!(
            message.contains(key) && message.contains("s.toml"),
            "{message}"
        );
    };
    for (text, key) in cases {
        refused(&format!("[planted]\n{text}\n{A}"), key);
    }
    refused(
        &format!("{A}tyres_driven_s = -1.0"),
        "runs[0].tyres_driven_s",
    );
    refused(
        &format!("{A}temperature_celsius = 61.0"),
        "runs[0].temperature_celsius",
    );
    let wind = |table: &str| format!("{A}wind = {table}");
    refused(
        &wind("{ speed_mps = -1.0, from_deg = 0.0 }"),
        "runs[0].wind.speed_mps",
    );
    refused(
        &wind("{ speed_mps = 1.0, from_deg = 361.0 }"),
        "runs[0].wind.from_deg",
    );
    refused(&wind("{ speed_mps = 1.0 }"), "from_deg");
    refused(
        &format!("[road]\nsmallest_radius_m = 300.0\nlargest_radius_m = 200.0\n{A}"),
        "road.largest_radius_m",
    );
}
