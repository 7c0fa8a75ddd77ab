//! Live grade and road ahead with a map of three runs by others, on the profile of the thesis's road.

use crate::drives::{Ahead, Errors, Truth, estimate, measured_road, rows, truth_at};
use host_sim::map::{MapRow, write_map};
use std::path::Path;
use test_kit::command::{folder, roadgrade};

/// Parameters that are wrong, of every run.
const ERRORS: &str = "mass_factor = 1.1\ndrag_factor = 0.9\nrolling_factor = 1.1\n\
                      torque_factor = 0.96\n";
/// The tunnel, as distances on the road.
const TUNNEL_M: std::ops::Range<f64> = 20_000.0..23_000.0;

fn run(folder: &Path, arguments: &[&str]) {
    roadgrade(folder, arguments).success();
}

/// Simulates drives of 40 km, each by a truck in wind from another direction.
fn simulate(folder: &Path, seed: u32, gnss: &str, drives: &[(&str, &str)]) {
    let mut scenario = format!("seed = {seed}\n[road]\nfile = \"road.csv\"\n[gnss]\n{gnss}\n");
    for (number, (name, truck)) in (0..).zip(drives) {
        scenario += &format!(
            "[[runs]]\nname = \"{name}\"\ntruck = \"{truck}\"\nlength_m = 40000.0\n\
             wind = {{ speed_mps = 2.0, from_deg = {}.0 }}\n[runs.errors]\n{ERRORS}",
            (72 * number + 40 * seed) % 360
        );
    }
    let file = format!("{seed}.toml");
    std::fs::write(folder.join(&file), scenario).expect("written");
    run(folder, &["simulate", "--scenario", &file, "--out", "."]);
}

/// Returns the errors of the road ahead.
fn errors_ahead(folder: &Path, name: &str) -> Errors {
    let (vehicle, log) = (format!("{name}.vehicle.toml"), format!("{name}.log"));
    let arguments = ["horizon", "--map", "map.grade", "--vehicle", &vehicle];
    run(
        folder,
        &[&arguments[..], &["--out", "ahead.csv", &log]].concat(),
    );
    let truth: Vec<Truth> = rows(&folder.join(format!("{name}.truth.csv")));
    let mut errors = Errors::default();
    for row in rows::<Ahead>(&folder.join("ahead.csv")) {
        let known = row.grade_percent.zip(row.grade_sigma_percent);
        let there = truth_at(&truth, row.distance_m + row.ahead_m);
        if let (0, Some((grade, sigma)), Some(truth)) = (row.branch, known, there) {
            errors.add(grade - truth, sigma);
        }
    }
    errors
}

/// Returns the grade of a profile that is linear between its rows.
fn between(profile: &[Truth], distance_m: f64) -> f64 {
    let next = profile.partition_point(|row| row.distance_m < distance_m);
    let (from, to) = (&profile[next - 1], &profile[next]);
    let part = (distance_m - from.distance_m) / (to.distance_m - from.distance_m);
    from.grade_percent + part * (to.grade_percent - from.grade_percent)
}

/// Makes the map of three runs by others. Returns its errors, without the ends of the road.
fn make_map(folder: &Path, seed: u32) -> Errors {
    let runs = ["m1", "m2", "m3"];
    simulate(folder, seed, "", &[("m1", "A"), ("m2", "A"), ("m3", "B")]);
    for name in runs {
        estimate(folder, name, &[]);
    }
    let files = ["m1.csv", "m2.csv", "m3.csv"];
    let arguments = ["fuse", "--out", "map.csv", "--road", "road.csv"];
    run(folder, &[&arguments[..], &files].concat());
    run(folder, &["pack", "map.csv", "--out", "map.grade"]);
    let profile: Vec<Truth> = rows(&folder.join("road.csv"));
    let mut errors = Errors::default();
    for row in rows::<MapRow>(&folder.join("map.csv")) {
        if (500.0..39_500.0).contains(&row.distance_m) {
            let error = row.grade_percent - between(&profile, row.distance_m);
            errors.add(error, row.grade_sigma_percent);
        }
    }
    errors
}

/// Packs two wrong maps: one that is 1 % too steep for 800 m in every 10 km, and one that is shifted by
/// 30 m along the road.
fn make_wrong_maps(folder: &Path) {
    let map: Vec<MapRow> = rows(&folder.join("map.csv"));
    let steeper = |row: &MapRow| {
        let is_wrong = (4_000.0..4_800.0).contains(&(row.distance_m % 10_000.0));
        let more_percent = if is_wrong { 1.0 } else { 0.0 };
        MapRow {
            grade_percent: row.grade_percent + more_percent,
            ..*row
        }
    };
    let shifted = |(row, ahead): (&MapRow, &MapRow)| MapRow {
        grade_percent: ahead.grade_percent,
        ..*row
    };
    let wrong: [(&str, Vec<MapRow>); 2] = [
        ("steeper", map.iter().map(steeper).collect()),
        ("shifted", map.iter().zip(&map[12..]).map(shifted).collect()),
    ];
    for (name, rows) in wrong {
        let [csv, packed] = ["csv", "grade"].map(|extension| format!("{name}.{extension}"));
        write_map(&folder.join(&csv), &rows).expect("written");
        run(folder, &["pack", &csv, "--out", &packed]);
    }
}

#[test]
fn with_a_map_of_others_the_live_grade_is_nearly_that_of_the_map() {
    let Some(road) = measured_road() else {
        return;
    };
    let [from_m, to_m] = [TUNNEL_M.start, TUNNEL_M.end];
    let outage = format!("outages_m = [[{from_m:.1}, {to_m:.1}]]");
    let drives = [("A", "A"), ("B", "B")];
    let mut of_map = Errors::default();
    // By truck: without the map, with it, the road ahead, in a tunnel, with wrong maps.
    let mut errors = [[Errors::default(); 6]; 2];
    for seed in [3, 13] {
        let folder = folder();
        let path = folder.path();
        std::fs::copy(&road, path.join("road.csv")).expect("copied");
        of_map += make_map(path, seed);
        make_wrong_maps(path);
        simulate(path, seed + 1, "", &drives);
        let options = ["--map", "map.grade"];
        for ((truck, _), of_truck) in drives.iter().zip(&mut errors) {
            let [without, with, ahead, _, steeper, shifted] = of_truck;
            without.add_drive(path, truck, &estimate(path, truck, &[]));
            with.add_drive(path, truck, &estimate(path, truck, &options));
            *ahead += errors_ahead(path, truck);
            for (errors, map) in [(steeper, "steeper.grade"), (shifted, "shifted.grade")] {
                errors.add_drive(path, truck, &estimate(path, truck, &["--map", map]));
            }
        }
        simulate(path, seed + 2, &outage, &drives);
        for ((truck, _), [_, _, _, dark, _, _]) in drives.iter().zip(&mut errors) {
            dark.add_live(path, truck, &estimate(path, truck, &options), TUNNEL_M);
        }
    }
    eprintln!("map {of_map}");
    for ((truck, _), of_truck) in drives.iter().zip(errors) {
        let [without, with, ahead, dark, steeper, shifted] = of_truck;
        eprintln!("{truck}: without {without}, with {with}, ahead {ahead}, in a tunnel {dark}");
        eprintln!("{truck}: with a steeper map {steeper}, with a shifted one {shifted}");
        for wrong in [steeper, shifted] {
            assert!(wrong.rms() <= 1.15 * without.rms(), "{truck}: {wrong}");
        }
        assert!(with.rms() <= 0.042, "{truck}: {with}");
        assert!(ahead.rms() <= 1.1 * of_map.rms(), "{truck}: {ahead}");
        assert!(dark.rms() <= 0.06, "{truck}: {dark}");
        for errors in [with, ahead, dark] {
            let normalised = errors.normalised();
            assert!((0.4..1.5).contains(&normalised), "{truck}: {normalised}");
        }
    }
}
