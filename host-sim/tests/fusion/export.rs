//! `roadgrade export`: a map as GeoJSON, as CSV way by way, and as a page.

use super::save;
use assert_cmd::assert::Assert;
use geojson::{Feature, FeatureCollection, Value as Shape};
use host_sim::map::{MapRow, WayDirection, WayName, WayRows, read_map, write_map};
use predicates::prelude::*;
use predicates::str::contains;
use std::path::Path;
use test_kit::command::{folder, roadgrade};
use test_kit::roads::network::{map, network, way};
use test_kit::roads::{hills, reversed, run, with_position_noise};

fn export(folder: &Path, arguments: &[&str]) -> Assert {
    roadgrade(folder, &[&["export"][..], arguments].concat())
}

/// Returns three ways of the hills, the second in both directions, with a hole in the first.
fn ways() -> Vec<WayRows> {
    let spots = hills();
    let network = network(&[
        way("a", "yes", &spots[..=800]),
        way("way/7", "no", &spots[800..=1600]),
        way("c", "yes", &spots[1600..]),
    ]);
    let rows: Vec<_> = (0..3)
        .map(|seed| run(&with_position_noise(&spots, 2.0, 80.0, seed)))
        .collect();
    let back = run(&reversed(&spots));
    let mut ways = map(&network, &[&rows[0], &rows[1], &rows[2][500..], &back]);
    ways[0].rows.drain(300..400);
    ways
}

fn features(path: &Path) -> Vec<Feature> {
    let text = std::fs::read_to_string(path).expect("text");
    let collection: FeatureCollection = text.parse().expect("GeoJSON");
    collection.features
}

fn line(feature: &Feature) -> Vec<[f64; 2]> {
    match feature.geometry.as_ref().map(|geometry| &geometry.value) {
        Some(Shape::LineString(coordinates)) => coordinates.iter().map(|p| [p[0], p[1]]).collect(),
        other => panic!("{other:?}"),
    }
}

fn number(feature: &Feature, key: &str) -> f64 {
    let value = feature.property(key).and_then(serde_json::Value::as_f64);
    value.unwrap_or_else(|| panic!("{key}: {:?}", feature.property(key)))
}

fn numbers(feature: &Feature, key: &str) -> Vec<f64> {
    let values = feature.property(key).and_then(serde_json::Value::as_array);
    let values = values.unwrap_or_else(|| panic!("{key}"));
    values
        .iter()
        .map(|value| value.as_f64().expect("a number"))
        .collect()
}

#[test]
fn geojson_has_the_map_way_by_way() {
    let folder = folder();
    let ways = ways();
    for map in ["map.csv", "map.parquet"] {
        save(folder.path(), map, &ways);
        export(folder.path(), &[map, "--out", "map.geojson"])
            .success()
            .stdout("")
            .stderr(contains("ways: 4"));
        let features = features(&folder.path().join("map.geojson"));
        // The hole divides the first way.
        let names: Vec<_> = features
            .iter()
            .map(|feature| {
                let text = |key: &str| feature.property(key).expect(key).as_str().expect("a text");
                (text("way").to_owned(), text("direction").to_owned())
            })
            .collect();
        let expected = [
            ("a", "forward"),
            ("a", "forward"),
            ("c", "forward"),
            ("way/7", "forward"),
            ("way/7", "backward"),
        ];
        assert_eq!(
            names,
            expected.map(|(way, to)| (way.to_owned(), to.to_owned()))
        );
        let mut rows = ways.iter().flat_map(|way| &way.rows);
        for feature in &features {
            let line = line(feature);
            let arrays = [
                "distances_m",
                "grades_percent",
                "grade_sigmas_percent",
                "altitudes_m",
                "runs",
            ]
            .map(|key| numbers(feature, key));
            assert!(arrays.iter().all(|values| values.len() == line.len()));
            for (i, [longitude, latitude]) in line.iter().enumerate() {
                let row = rows.next().expect("a row");
                // 7 decimals, longitude first.
                assert!((longitude - row.longitude_deg).abs() <= 0.51e-7, "{row:?}");
                assert!((latitude - row.latitude_deg).abs() <= 0.51e-7);
                assert!((longitude * 1e7 - (longitude * 1e7).round()).abs() < 1e-6);
                assert!((arrays[0][i] - row.distance_m).abs() < 0.01);
                assert!((arrays[1][i] - row.grade_percent).abs() < 1e-5);
                assert!((arrays[2][i] - row.grade_sigma_percent).abs() < 1e-5);
                assert!((arrays[3][i] - row.altitude_m.expect("known")).abs() < 1e-3);
                assert!((arrays[4][i] - f64::from(row.runs)).abs() < 1e-9);
            }
            let length_m = number(feature, "to_m") - number(feature, "from_m");
            assert!((number(feature, "length_m") - length_m).abs() < 1e-9);
            assert!((length_m - 2.5 * (line.len() - 1) as f64).abs() < 1e-6);
        }
        assert!(rows.next().is_none(), "every row is drawn");
    }
}

#[test]
fn pieces_are_short_lines_with_numbers() {
    let folder = folder();
    let ways = ways();
    save(folder.path(), "map.csv", &ways);
    for (metres, cells) in [("2.5", 1), ("50", 20)] {
        export(
            folder.path(),
            &["map.csv", "--out", "p.geojson", "--pieces", metres],
        )
        .success();
        let features = features(&folder.path().join("p.geojson"));
        let segments: usize = features.iter().map(|feature| line(feature).len() - 1).sum();
        let rows: usize = ways.iter().map(|way| way.rows.len()).sum();
        // Five stretches.
        assert_eq!(segments, rows - 5);
        for pair in features.windows(2) {
            let (a, b) = (line(&pair[0]), line(&pair[1]));
            if pair[0].property("way") == pair[1].property("way")
                && number(&pair[0], "to_m") == number(&pair[1], "from_m")
            {
                assert_eq!(a[a.len() - 1], b[0], "pieces touch");
            }
        }
        assert!(
            features
                .iter()
                .all(|feature| line(feature).len() <= cells + 1)
        );
        assert!(
            features
                .iter()
                .all(|feature| feature.property("grades_percent").is_none())
        );
        let of_c: Vec<&Feature> = features
            .iter()
            .filter(|feature| feature.property("way").expect("way") == "c")
            .collect();
        for feature in of_c {
            let middle_m = 4000.0 + 0.5 * (number(feature, "from_m") + number(feature, "to_m"));
            let off = number(feature, "grade_percent") - test_kit::roads::hill_percent(middle_m);
            assert!(off.abs() < 0.1, "{off}");
            assert!(number(feature, "grade_sigma_percent") > 0.01);
            assert!(number(feature, "runs_least") >= 2.0);
        }
    }
}

fn at(distance_m: f64, longitude_deg: f64) -> MapRow {
    MapRow {
        distance_m,
        latitude_deg: 10.0,
        longitude_deg,
        altitude_m: None,
        grade_percent: 1.0,
        grade_sigma_percent: 0.1,
        runs: 1,
    }
}

#[test]
fn a_lone_cell_is_a_point_and_the_date_line_cuts() {
    let folder = folder();
    let rows = [
        at(0.0, 179.999_96),
        at(2.5, 179.999_98),
        at(5.0, -179.999_99),
        at(7.5, -179.999_97),
        at(100.0, -179.99),
    ];
    write_map(&folder.path().join("map.csv"), &rows).expect("written");
    export(folder.path(), &["map.csv", "--out", "map.geojson"]).success();
    let features = features(&folder.path().join("map.geojson"));
    assert_eq!(features.len(), 3);
    assert_eq!(line(&features[0]).len(), 2);
    assert_eq!(line(&features[1])[0][0], -179.999_99);
    let lone = features[2].geometry.as_ref().expect("a geometry");
    assert_eq!(lone.value.type_name(), "Point");
    // A single road has no name, and no altitude is null, not a number.
    assert!(
        features
            .iter()
            .all(|feature| feature.property("way").is_none())
    );
    assert!(
        features
            .iter()
            .all(|feature| feature.property("altitude_m").expect("altitude").is_null())
    );
}

#[test]
fn each_way_becomes_a_map_of_its_own() {
    let folder = folder();
    let mut ways = ways();
    // `way/7` is impossible as a file name, and `way_7` is possible.
    let twin = WayName {
        way: "way_7".to_owned(),
        direction: WayDirection::Forward,
    };
    ways.push(WayRows {
        name: Some(twin),
        rows: ways[1].rows.clone(),
    });
    save(folder.path(), "map.parquet", &ways);
    export(folder.path(), &["map.parquet", "--out", "new/ways"]).success();
    let out = folder.path().join("new/ways");
    let mut names: Vec<String> = std::fs::read_dir(&out)
        .expect("a folder")
        .map(|entry| {
            entry
                .expect("a file")
                .file_name()
                .into_string()
                .expect("text")
        })
        .collect();
    names.sort();
    assert_eq!(
        names,
        [
            "a.csv",
            "c.csv",
            "way_7-2.csv",
            "way_7.backward.csv",
            "way_7.csv"
        ]
    );
    let rows = read_map(&out.join("way_7.backward.csv")).expect("a map");
    let expected = &ways[3];
    assert_eq!(rows.len(), expected.rows.len());
    for (a, b) in rows.iter().zip(&expected.rows) {
        assert!((a.grade_percent - b.grade_percent).abs() < 1e-5);
    }
    let beside = std::fs::read_dir(folder.path().join("new")).expect("a folder");
    assert_eq!(beside.count(), 1, "nothing is left beside");

    // Into an existing folder. A single road has the map's name.
    write_map(&folder.path().join("road.csv"), &ways[0].rows).expect("written");
    export(folder.path(), &["road.csv", "--out", "new/ways"]).success();
    assert_eq!(
        read_map(&out.join("road.csv")).expect("a map").len(),
        ways[0].rows.len()
    );
    assert!(out.join("a.csv").exists());
}

#[test]
fn the_page_draws_plan_profiles_and_uncertainty() {
    let folder = folder();
    save(folder.path(), "hills.csv", &ways());
    export(folder.path(), &["hills.csv", "--out", "map.html"]).success();
    let page = std::fs::read_to_string(folder.path().join("map.html")).expect("a page");
    assert!(page.contains("<h1>Grade map: hills</h1>"));
    for part in [
        "\"kind\":\"plan\"",
        "Way way/7 backward",
        "± 2 sigma",
        "altitude (m)",
        "Number of runs.",
        "climb m",
    ] {
        assert!(page.contains(part), "{part}");
    }
    // One plan; altitude, grade and runs of each way, of which one has a single run. The plan's line of
    // a way shares its link with them; the hole in the first way makes two lines.
    assert_eq!(page.matches("class=\"drawing\" ").count(), 1 + 3 * 4 - 1);
    let links = |link: &str| page.matches(&format!("\"link\":\"{link}\"")).count();
    assert_eq!(links("way way/7 backward"), 1 + 2);
    assert_eq!(links("way a forward"), 2 + 3);

    // A map of one cell is drawn, too.
    write_map(&folder.path().join("one.csv"), &[at(0.0, 8.0)]).expect("written");
    export(folder.path(), &["one.csv", "--out", "one.html"]).success();
    let page = std::fs::read_to_string(folder.path().join("one.html")).expect("a page");
    assert!(page.contains("Along the road") && !page.contains("NaN"));
}

#[test]
fn impossible_exports_are_refused() {
    let folder = folder();
    save(folder.path(), "map.csv", &ways());
    for arguments in [
        &["map.csv"][..],
        &["map.csv", "--out", "map.txt"],
        &["map.csv", "--out", "map.html", "--pieces", "50"],
        &["map.csv", "--out", "map.geojson", "--pieces", "1"],
        &["map.csv", "--out", "map.geojson", "--pieces", "NaN"],
        &["map.csv", "--out", "map.geojson", "--format", "shapefile"],
    ] {
        export(folder.path(), arguments)
            .failure()
            .code(2)
            .stdout("");
    }
    let mut text = std::fs::read_to_string(folder.path().join("map.csv")).expect("text");
    text = text.replacen("a,forward,5.0,", "a,forward,0.0,", 1);
    std::fs::write(folder.path().join("bad.csv"), &text).expect("written");
    std::fs::write(folder.path().join("empty.csv"), "").expect("written");
    std::fs::write(folder.path().join("bad.parquet"), &text).expect("written");
    for (map, expected) in [
        ("none.csv", "none.csv: "),
        ("empty.csv", "empty.csv: no rows"),
        ("bad.csv", "bad.csv:4: distance_m is 0 after 2.5"),
        ("bad.parquet", "bad.parquet: damaged, or not a Parquet file"),
    ] {
        for out in ["x.geojson", "x.html", "x"] {
            export(folder.path(), &[map, "--out", out])
                .failure()
                .code(1)
                .stderr(contains(expected).and(contains("panicked").not()));
            assert!(!folder.path().join(out).exists(), "{map} {out}");
        }
    }
    export(
        folder.path(),
        &["map.csv", "--out", "map.txt", "--format", "geojson"],
    )
    .success();
    assert_eq!(features(&folder.path().join("map.txt")).len(), 5);
}
