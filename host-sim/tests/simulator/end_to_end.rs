//! `roadgrade simulate` from end to end: files, repeatability, bad scenarios.

use assert_cmd::cargo::cargo_bin_cmd;
use estimator_core::Traction;
use host_sim::files::oracle::OracleFile;
use host_sim::files::truth;
use host_sim::files::vehicle::VehicleFile;
use host_sim::source::can_frame::{CanFrame, TimedFrame};
use host_sim::source::candump_writer::write_frame;
use predicates::prelude::PredicateBooleanExt;
use predicates::str::contains;
use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

const SHORT: &str = r#"
seed = 3
[road]
length_m = 1500.0
[[runs]]
name = "a"
truck = "A"
[[runs]]
name = "b"
truck = "B"
direction = "backward"
start_time_s = 1000.0
errors = { mass_sigma = 0.1 }
"#;

fn simulate(scenario: &str, folder: &Path) -> assert_cmd::assert::Assert {
    let file = folder.join("scenario.toml");
    fs::write(&file, scenario).unwrap();
    cargo_bin_cmd!("roadgrade")
        .args(["simulate", "--scenario"])
        .arg(&file)
        .arg("--out")
        .arg(folder.join("out"))
        .assert()
}

/// Returns name and content of every file that a scenario makes.
fn output(scenario: &str) -> BTreeMap<String, Vec<u8>> {
    let folder = tempfile::tempdir().unwrap();
    simulate(scenario, folder.path()).success();
    fs::read_dir(folder.path().join("out"))
        .unwrap()
        .map(|entry| {
            let entry = entry.unwrap();
            let name = entry.file_name().into_string().unwrap();
            (name, fs::read(entry.path()).unwrap())
        })
        .collect()
}

#[test]
fn every_run_writes_its_files() {
    let files = output(SHORT);
    let names: Vec<&str> = files.keys().map(String::as_str).collect();
    assert_eq!(
        names,
        [
            "a.log",
            "a.oracle.toml",
            "a.truth.csv",
            "a.vehicle.toml",
            "b.log",
            "b.oracle.toml",
            "b.truth.csv",
            "b.vehicle.toml",
            "road.csv"
        ]
    );
    let log = String::from_utf8(files["b.log"].clone()).unwrap();
    assert!(log.starts_with("(1000.5"), "{}", &log[..40]);
    assert!(log.lines().all(|line| line.contains(") can0 ")));
}

#[test]
fn runs_with_one_vehicle_share_its_file() {
    let same = SHORT.replace("truck = \"B\"", "truck = \"A\"");
    let files = output(&same);
    // The file of the estimator does not have the true mass.
    assert_eq!(files["vehicle.toml"], files["a.vehicle.toml"]);
    assert_eq!(files["vehicle.toml"], files["b.vehicle.toml"]);
}

#[test]
fn the_oracle_file_has_the_true_parameters() {
    let folder = tempfile::tempdir().unwrap();
    let exact = "errors = { mass_factor = 1.1, torque_factor = 0.96 }";
    let windy = format!(
        "{}[wind]\nspeed_mps = 3.0\nfrom_deg = 225.0\n[tyres]\ncold_amount = 0.4\n\
         [gnss]\naltitude_sigma_m = 7.0\n[latency_ms]\ngnss = 250.0\n",
        SHORT.replace("errors = { mass_sigma = 0.1 }", exact)
    );
    simulate(&windy, folder.path()).success();
    let read = |name: &str| OracleFile::read(&folder.path().join("out").join(name)).unwrap();
    let (a, b) = (read("a.oracle.toml"), read("b.oracle.toml"));
    assert_eq!(a.vehicle.model.vehicle.mass_kg, 39_000.0);
    assert_eq!(b.vehicle.name, "B");
    assert!((b.vehicle.model.vehicle.mass_kg - 13_200.0).abs() < 0.1);
    let Traction::Powertrain(powertrain) = &b.vehicle.model.vehicle.traction else {
        panic!("it has one");
    };
    assert!((powertrain.reference_torque_nm - 0.96 * 2370.0).abs() < 0.1);
    let noise = b.noise;
    assert_eq!(noise.speed_sigma_mps, 0.011);
    assert_eq!(
        (noise.gnss_slow.sigma_m, noise.gnss_slow.time_s),
        (7.0, 250.0)
    );
    assert_eq!(
        (noise.gnss_white_sigma_m, noise.gnss_latency_s),
        (0.3, 0.25)
    );
    assert_eq!(noise.cold_tyres.unwrap().amount, 0.4);
    // The start of the road is against the wind.
    let headwind = a.noise.headwind.unwrap();
    assert!((2.5..=3.0).contains(&headwind.sigma_mps), "{headwind:?}");
    assert!(headwind.time_s > 100.0, "{headwind:?}");
}

#[test]
fn written_files_can_be_read_again() {
    let folder = tempfile::tempdir().unwrap();
    simulate(SHORT, folder.path()).success();
    let out = folder.path().join("out");
    let vehicle = VehicleFile::read(&out.join("b.vehicle.toml")).unwrap();
    assert_eq!(vehicle.model.vehicle.mass_kg, 12_000.0);
    let truth = truth::read(&out.join("b.truth.csv")).unwrap();
    assert_eq!((truth[0].time_s, truth[0].distance_m), (0.0, 0.0));
    let last = truth.last().unwrap();
    assert!((1480.0..1500.0).contains(&last.distance_m), "{last:?}");

    // Another scenario uses the road and the vehicle of this one.
    let again = r#"
        road.file = "out/road.csv"
        [[runs]]
        name = "again"
        vehicle = "out/a.vehicle.toml"
    "#;
    simulate(again, folder.path()).success();
    let [before, after] =
        ["a.truth.csv", "again.truth.csv"].map(|name| truth::read(&out.join(name)).unwrap());
    assert!(!before.is_empty());
    for (a, b) in before.iter().zip(&after) {
        assert!((a.altitude_m - b.altitude_m).abs() < 0.05, "{a:?} {b:?}");
    }
}

#[test]
fn the_same_scenario_gives_the_same_bytes() {
    let first = output(SHORT);
    assert_eq!(first, output(SHORT));
    let other = output(&SHORT.replace("seed = 3", "seed = 4"));
    for name in ["a.log", "b.log", "road.csv"] {
        assert_ne!(first[name], other[name], "{name}");
    }
}

#[test]
fn a_run_does_not_depend_on_the_ones_after_it() {
    let alone = SHORT.split("[[runs]]\nname = \"b\"").next().unwrap();
    assert_eq!(output(SHORT)["a.log"], output(alone)["a.log"]);
}

#[test]
fn bad_scenarios_name_the_key_and_write_nothing() {
    let run = "[[runs]]\nname = \"x\"\ntruck = \"A\"\n";
    let cases = [
        ("seed = 1".to_owned(), "runs"),
        (String::new(), "runs"),
        (format!("colour = 3\n{run}"), "colour"),
        (format!("[road]\nlenght_m = 3.0\n{run}"), "lenght_m"),
        (format!("[road]\nlength_m = -3.0\n{run}"), "road.length_m"),
        (format!("[road]\nlength_m = nan\n{run}"), "road.length_m"),
        (
            format!("[road]\nfile = \"r.csv\"\nlength_m = 9.0\n{run}"),
            "length_m",
        ),
        (format!("[road]\nfile = \"r.csv\"\n{run}"), "r.csv"),
        (
            format!("[noise]\nspeed_sigma_mps = -1.0\n{run}"),
            "noise.speed_sigma_mps",
        ),
        (
            format!("[gnss]\naltitude_time_s = 0.0\n{run}"),
            "gnss.altitude_time_s",
        ),
        (
            format!("[gnss]\noutages_m = [[9.0, 3.0]]\n{run}"),
            "gnss.outages_m",
        ),
        (format!("[rates]\nfast_ms = 1.0\n{run}"), "rates.fast_ms"),
        (
            format!("[latency_ms]\ngnss = -1.0\n{run}"),
            "latency_ms.gnss",
        ),
        (
            format!("[air]\npressure_pa = 0.0\n{run}"),
            "air.pressure_pa",
        ),
        (format!("{run}mass_kg = -39000.0"), "runs[0].mass_kg"),
        (format!("{run}masss_kg = 1.0"), "masss_kg"),
        (format!("{run}direction = \"up\""), "direction"),
        (format!("{run}length_m = 1e9"), "runs[0].length_m"),
        (
            format!("{run}start_distance_m = -1.0"),
            "runs[0].start_distance_m",
        ),
        (
            format!("{run}errors.mass_factor = -1.0"),
            "runs[0].errors.mass_factor",
        ),
        (
            format!("{run}errors = {{ mass_factor = 1.0, mass_sigma = 0.1 }}"),
            "mass_sigma",
        ),
        (format!("{run}errors.wind = 1.0"), "wind"),
        (format!("{run}vehicle = \"v.toml\""), "runs[0].truck"),
        ("[[runs]]\nname = \"x\"".to_owned(), "runs[0].truck"),
        ("[[runs]]\ntruck = \"A\"".to_owned(), "name"),
        ("[[runs]]\nname = \"x\"\ntruck = \"C\"".to_owned(), "truck"),
        (
            "[[runs]]\nname = \"x\"\nvehicle = \"v.toml\"".to_owned(),
            "v.toml",
        ),
        (
            "[[runs]]\nname = \"../x\"\ntruck = \"A\"".to_owned(),
            "runs[0].name",
        ),
        (format!("{run}{run}"), "runs[1].name"),
        ("runs = 3".to_owned(), "runs"),
        ("not toml at all".to_owned(), "scenario.toml"),
        // 100 t up a slope of 15 %: no engine of these can do it.
        (
            format!(
                "[road]\ngrade_sigma_percent = 10.0\nlargest_grade_percent = 15.0\n\
                 largest_change_percent_per_m = 0.1\n{run}mass_kg = 150000.0"
            ),
            "stuck",
        ),
    ];
    for (scenario, key) in cases {
        let folder = tempfile::tempdir().unwrap();
        simulate(&scenario, folder.path())
            .code(1)
            .stderr(contains(key).and(contains("panicked").not()))
            .stdout("");
        assert!(!folder.path().join("out").exists(), "{scenario}");
    }
}

#[test]
fn bad_roads_and_vehicles_are_refused() {
    const HEADER: &str = "distance_m,latitude_deg,longitude_deg,altitude_m,grade_percent\n";
    let cases = [
        ("", "road.csv"),
        (HEADER, "road.csv"),
        ("0,59,17,10,0\n", "two"),
        ("0,59,17,10,0\n0,59,17,10,0\n", "road.csv:3: distance_m"),
        ("0,59,17,10,0\n9,99,17,10,0\n", "road.csv:3: latitude_deg"),
        ("0,59,17,10,0\n9,59,17,10,50\n", "road.csv:3: grade_percent"),
        ("0,59,17,10,0\n9,59,17,10,steep\n", "road.csv:3"),
        ("0,59,17,10,0\n9,59,17,NaN,0\n", "road.csv:3: altitude_m"),
    ];
    for (rows, message) in cases {
        let folder = tempfile::tempdir().unwrap();
        let text = if rows.is_empty() || rows == HEADER {
            rows.to_owned()
        } else {
            format!("{HEADER}{rows}")
        };
        fs::write(folder.path().join("road.csv"), text).unwrap();
        let scenario = "road.file = \"road.csv\"\n[[runs]]\nname = \"x\"\ntruck = \"A\"";
        simulate(scenario, folder.path())
            .code(1)
            .stderr(contains(message));
        assert!(!folder.path().join("out").exists());
    }

    let folder = tempfile::tempdir().unwrap();
    let vehicle = "[vehicle]\nname = \"bus\"\nmass_kg = 19000.0\ndrag_area_m2 = 5.2\n\
        rolling_resistance = 0.008\nwheel_radius_m = 0.48\nwheel_inertia_kgm2 = 60.0\n\
        [traction]\nsource = \"force\"\n";
    fs::write(folder.path().join("v.toml"), vehicle).unwrap();
    simulate(
        "[[runs]]\nname = \"x\"\nvehicle = \"v.toml\"",
        folder.path(),
    )
    .code(1)
    .stderr(contains("powertrain"));
}

#[test]
fn a_missing_scenario_is_named() {
    let folder = tempfile::tempdir().unwrap();
    cargo_bin_cmd!("roadgrade")
        .args(["simulate", "--scenario", "nowhere.toml", "--out"])
        .arg(folder.path().join("out"))
        .assert()
        .code(1)
        .stderr(contains("nowhere.toml"));
    assert!(!folder.path().join("out").exists());
}

#[test]
fn wrong_usage_exits_with_two() {
    cargo_bin_cmd!("roadgrade")
        .arg("simulate")
        .assert()
        .code(2)
        .stderr(contains("--scenario"));
}

#[test]
fn lines_are_those_of_candump() {
    let time = estimator_core::Instant::from_micros(1_000_042);
    let line = |frame: CanFrame| {
        let mut text = Vec::new();
        write_frame(&mut text, &TimedFrame { time, frame }, "can0").unwrap();
        String::from_utf8(text).unwrap()
    };
    let extended = CanFrame::extended(0x0cf0_0400, &[1, 2, 0xab, 4, 5, 6, 7, 0xff]).unwrap();
    assert_eq!(
        line(extended),
        "(1.000042) can0 0CF00400#0102AB04050607FF\n"
    );
    let standard = CanFrame::standard(0x7, &[]).unwrap();
    assert_eq!(line(standard), "(1.000042) can0 007#\n");
    let remote = embedded_can::Frame::new_remote(embedded_can::StandardId::new(0x123).unwrap(), 3);
    assert_eq!(line(remote.unwrap()), "(1.000042) can0 123#R3\n");
}
