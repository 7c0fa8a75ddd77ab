//! Effects in `vehicle.toml`: they are read, written, refused by name, and used by `estimate`.

use host_sim::files::run;
use host_sim::files::vehicle::VehicleFile;
use predicates::str::contains;
use std::fs;
use tempfile::TempDir;
use test_kit::command::roadgrade;

const BUS: &str = r#"
[vehicle]
name = "bus"
mass_kg = 19000.0
drag_area_m2 = 5.2
rolling_resistance = 0.008
wheel_radius_m = 0.48
wheel_inertia_kgm2 = 100.0

[traction]
source = "force"
"#;

/// Reads a vehicle file with these effects.
fn read(effects: &str) -> Result<VehicleFile, String> {
    let folder = TempDir::new().unwrap();
    let path = folder.path().join("v.toml");
    fs::write(&path, format!("{BUS}{effects}")).unwrap();
    VehicleFile::read(&path).map_err(|error| {
        let text = error.to_string();
        assert!(text.contains("v.toml: "), "{text}");
        text
    })
}

#[test]
fn effects_are_read_and_written_back() {
    let file = read(
        "[effects.tyre_warmup]\namount = 0.3\namount_sigma = 0.04\n\
         [effects.headwind]\namount = -3\namount_sigma = 1\nfrom_deg = 270\n\
         [effects.brake_drag]\namount_sigma = 0.0\namount = 250.5\n",
    )
    .unwrap();
    let found: Vec<_> = file
        .model
        .effects
        .iter()
        .map(|adopted| {
            let given: Vec<_> = adopted.given_parameters().collect();
            (
                adopted.effect.name,
                adopted.amount,
                adopted.amount_sigma,
                given,
            )
        })
        .collect();
    let expected = [
        ("brake_drag", 250.5, 0.0, vec![]),
        ("headwind", -3.0, 1.0, vec![("from_deg", 270.0)]),
        ("tyre_warmup", 0.3, 0.04, vec![("time_s", 1_500.0)]),
    ];
    assert_eq!(found, expected);

    let folder = TempDir::new().unwrap();
    let path = folder.path().join("v.toml");
    file.write(&path).unwrap();
    assert_eq!(VehicleFile::read(&path).unwrap(), file);
    let text = fs::read_to_string(&path).unwrap();
    let warmup = "[effects.tyre_warmup]\namount = 0.3\namount_sigma = 0.04\ntime_s = 1500.0\n";
    assert!(text.contains(warmup), "{text}");
}

#[test]
fn without_effects_the_file_does_not_mention_them() {
    let file = read("").unwrap();
    assert!(file.model.effects.is_empty());
    assert!(!file.to_toml().contains("effects"));
}

#[test]
fn errors_of_effects_are_named() {
    for (effects, expected) in [
        (
            "[effects.tire_warmup]\namount = 1\namount_sigma = 0\n",
            "effects.tire_warmup: unknown effect; expected one of rolling_resistance, ",
        ),
        (
            "[effects.mass]\namount = 0.1\n",
            "effects.mass.amount_sigma: missing",
        ),
        (
            "[effects.mass]\namount_sigma = 0.1\n",
            "effects.mass.amount: missing",
        ),
        ("[effects.mass]\n", "effects.mass.amount: missing"),
        (
            "[effects.mass]\namount = 0.1\namount_sigma = 0\ntime_s = 3\n",
            "effects.mass.time_s: unknown key; expected one of amount, amount_sigma",
        ),
        (
            "[effects.headwind]\namount = 0.1\namount_sigma = 0\nfrom = 3\n",
            "effects.headwind.from: unknown key; expected one of amount, amount_sigma, from_deg",
        ),
        (
            "[effects.headwind]\namount = 99.0\namount_sigma = 0\n",
            "effects.headwind.amount = 99: expected -40 to 40 m/s",
        ),
        (
            "[effects.headwind]\namount = nan\namount_sigma = 0\n",
            "effects.headwind.amount = NaN: expected -40 to 40 m/s",
        ),
        (
            "[effects.headwind]\namount = 3\namount_sigma = -1\n",
            "effects.headwind.amount_sigma = -1: expected",
        ),
        (
            "[effects.headwind]\namount = 3\namount_sigma = 1\nfrom_deg = 400\n",
            "effects.headwind.from_deg = 400: expected 0 to 360°",
        ),
        (
            "[effects.headwind]\namount = \"3\"\namount_sigma = 1\n",
            "amount = \"3\"",
        ),
        ("[effects]\nheadwind = 3\n", "headwind = 3"),
        (
            "[effects.mass]\namount = 0\namount_sigma = 0\n[effects.mass]\namount = 0\n",
            "duplicate key",
        ),
        ("[effect.mass]\namount = 0\n", "unknown field `effect`"),
    ] {
        let error = read(effects).unwrap_err();
        assert!(error.contains(expected), "{effects}: {error}");
    }
}

/// What EC1 says of the engine goes before the vehicle file.
const OWN: &str = "reference_torque_nm";

#[test]
fn an_estimate_counts_with_the_effects_of_its_vehicle() {
    let folder = TempDir::new().unwrap();
    let scenario = "seed = 3\n[road]\nlength_m = 3000.0\n[[runs]]\nname = \"a\"\ntruck = \"A\"\n";
    let file = |name: &str| folder.path().join(name);
    fs::write(file("s.toml"), scenario).unwrap();
    roadgrade(
        folder.path(),
        &["simulate", "--scenario", "s.toml", "--out", "."],
    )
    .success();

    // Reported torque is 5 % too small, with and without the effect in the file.
    let plain = fs::read_to_string(file("a.vehicle.toml")).unwrap();
    let wrong = plain.replace(
        "reference_torque_nm = 1750.0",
        "reference_torque_nm = 1666.6666",
    );
    assert_ne!(wrong, plain);
    let effect = "\n[effects.torque_scale]\namount = 0.05\namount_sigma = 0.0\n";
    let mut grades = Vec::new();
    for (name, text) in [
        ("plain", plain.clone()),
        ("known", format!("{wrong}{effect}")),
        ("wrong", wrong.clone()),
    ] {
        let vehicle = format!("{name}.toml");
        fs::write(file(&vehicle), text).unwrap();
        let out = format!("{name}.csv");
        let arguments = [
            "estimate",
            "--vehicle",
            &vehicle,
            "--out",
            &out,
            "--ignore",
            OWN,
            "a.log",
        ];
        roadgrade(folder.path(), &arguments).success();
        let rows = run::read(&file(&out)).unwrap();
        grades.push(rows.iter().map(|row| row.live_grade_percent).collect());
    }
    let grades: [Vec<f64>; 3] = grades.try_into().unwrap();
    let off = |k: usize| {
        let pairs = grades[k].iter().zip(&grades[0]);
        pairs
            .map(|(one, plain)| (one - plain).abs())
            .fold(0.0, f64::max)
    };
    assert!(off(1) < 1e-3, "{}", off(1));
    assert!(off(2) > 0.05, "{}", off(2));

    // A wrong effect is reported, and no file is written.
    fs::write(
        file("bad.toml"),
        format!("{plain}\n[effects.wind]\namount = 1.0\n"),
    )
    .unwrap();
    let arguments = [
        "estimate",
        "--vehicle",
        "bad.toml",
        "--out",
        "bad.csv",
        "a.log",
    ];
    roadgrade(folder.path(), &arguments)
        .code(1)
        .stderr(contains("bad.toml: effects.wind: unknown effect"));
    assert!(!file("bad.csv").exists());
}
