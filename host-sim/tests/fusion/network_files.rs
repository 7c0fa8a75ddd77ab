//! Files of networks and of their maps: what is read, and what is refused.

use assert_cmd::assert::Assert;
use host_sim::files::run::{self, RunRow};
use host_sim::map::{read_map_ways, read_network};
use predicates::prelude::*;
use predicates::str::contains;
use serde_json::{Value, json};
use std::fmt::Write as _;
use std::path::Path;
use test_kit::command::{folder, roadgrade};
use test_kit::roads::network::{collection, save, way};
use test_kit::roads::{Spot, hills, reversed, run, with_position_noise};

fn fuse(folder: &Path, arguments: &[&str]) -> Assert {
    roadgrade(folder, &[&["fuse"][..], arguments].concat())
}

fn save_run(folder: &Path, name: &str, rows: &[RunRow]) {
    run::write(&folder.join(name), rows).expect("written");
}

fn bytes(folder: &Path, name: &str) -> Vec<u8> {
    std::fs::read(folder.join(name)).expect(name)
}

/// Returns the hills in three ways, the middle one with both directions.
fn three(spots: &[Spot]) -> Vec<Value> {
    vec![
        way("a", "yes", &spots[..=800]),
        way("b", "no", &spots[800..=1600]),
        way("c", "yes", &spots[1600..]),
    ]
}

fn drives(folder: &Path) {
    let spots = hills();
    for seed in 0..3 {
        let rows = run(&with_position_noise(&spots, 3.0, 80.0, seed));
        save_run(folder, &format!("{seed}.csv"), &rows);
    }
    let back = run(&with_position_noise(&reversed(&spots), 3.0, 80.0, 9));
    save_run(folder, "back.csv", &back);
}

fn length_m(way: &host_sim::map::Way) -> f64 {
    way.line.end_m()
}

#[test]
fn a_network_makes_a_map_of_ways_in_whatever_order_it_comes() {
    let folder = folder();
    let at = folder.path();
    drives(at);
    let mut ways = three(&hills());
    save(&at.join("net.geojson"), &ways);
    let runs = ["0.csv", "1.csv", "back.csv"];
    fuse(
        at,
        &[&["--out", "map.csv", "--road", "net.geojson"][..], &runs].concat(),
    )
    .success()
    .stdout("")
    .stderr(contains("km on 4 ways"));
    let text = String::from_utf8(bytes(at, "map.csv")).expect("text");
    assert!(text.starts_with(
        "way,direction,distance_m,latitude_deg,longitude_deg,altitude_m,grade_percent,\
         grade_sigma_percent,runs\na,forward,0.0,"
    ));
    let map = read_map_ways(&at.join("map.csv")).expect("a map");
    let names: Vec<String> = map
        .iter()
        .map(|way| way.name.as_ref().expect("a name").to_string())
        .collect();
    assert_eq!(names, ["a forward", "b forward", "b backward", "c forward"]);

    ways.rotate_left(1);
    ways.swap(0, 1);
    save(&at.join("other.geojson"), &ways);
    fuse(
        at,
        &[
            &["--out", "again.csv", "--road", "other.geojson"][..],
            &runs,
        ]
        .concat(),
    )
    .success();
    assert_eq!(bytes(at, "map.csv"), bytes(at, "again.csv"));

    // As Parquet, and with the map as the network.
    fuse(
        at,
        &[
            &["--out", "map.parquet", "--road", "net.geojson"][..],
            &runs,
        ]
        .concat(),
    )
    .success();
    let parquet = read_map_ways(&at.join("map.parquet")).expect("a map");
    assert_eq!(parquet.len(), map.len());
    for (a, b) in map.iter().zip(&parquet) {
        assert_eq!((&a.name, a.rows.len()), (&b.name, b.rows.len()));
        for (a, b) in a.rows.iter().zip(&b.rows) {
            assert!((a.grade_percent - b.grade_percent).abs() <= 0.5e-5);
        }
    }
    for network in ["map.csv", "map.parquet"] {
        let road = ["--out", "third.csv", "--road", network];
        fuse(at, &[&road[..], &runs].concat()).success();
        let third = read_map_ways(&at.join("third.csv")).expect("a map");
        for (a, b) in map.iter().zip(&third) {
            assert_eq!(a.name, b.name);
            assert!(a.rows.len().abs_diff(b.rows.len()) <= 3, "{:?}", a.name);
        }
    }
}

#[test]
fn ways_may_come_as_csv() {
    let folder = folder();
    let at = folder.path();
    drives(at);
    let spots = hills();
    let mut text = String::from("way,distance_m,latitude_deg,longitude_deg\n");
    for (name, part) in [("a", &spots[..=800]), ("b", &spots[800..])] {
        for spot in part {
            let (latitude, longitude) = spot.latitude_longitude_deg();
            let along_m = spot.distance_m - part[0].distance_m;
            writeln!(text, "{name},{along_m},{latitude:.7},{longitude:.7}").expect("memory");
        }
    }
    std::fs::write(at.join("road.csv"), &text).expect("written");
    fuse(at, &["--out", "map.csv", "--road", "road.csv", "0.csv"]).success();
    let map = read_map_ways(&at.join("map.csv")).expect("a map");
    let lengths: Vec<usize> = map.iter().map(|way| way.rows.len()).collect();
    assert!(
        lengths.len() == 2 && lengths[0] > 797 && lengths[1] > 1590,
        "{lengths:?}"
    );

    // A way in two pieces, and an empty name.
    let lines: Vec<&str> = text.lines().collect();
    let torn = [&lines[..1], &lines[2..], &lines[1..2]].concat().join("\n");
    std::fs::write(at.join("torn.csv"), torn).expect("written");
    fuse(at, &["--out", "no.csv", "--road", "torn.csv", "0.csv"])
        .failure()
        .code(1)
        .stderr(contains("torn.csv:2403: way a forward appears twice"));
    std::fs::write(at.join("unnamed.csv"), text.replace("\nb,", "\n ,")).expect("written");
    fuse(at, &["--out", "no.csv", "--road", "unnamed.csv", "0.csv"])
        .failure()
        .code(1)
        .stderr(contains("unnamed.csv:803: way is \" \""));
    std::fs::write(at.join("turned.csv"), text.replace("way,", "direction,")).expect("written");
    fuse(at, &["--out", "no.csv", "--road", "turned.csv", "0.csv"])
        .failure()
        .code(1)
        .stderr(contains("turned.csv:803: distance_m is 0 after 2000"));
    assert!(!at.join("no.csv").exists());
}

#[test]
fn a_store_of_a_network_grows_run_by_run() {
    let folder = folder();
    let at = folder.path();
    drives(at);
    save(&at.join("net.geojson"), &three(&hills()));
    let whole = [
        "--out",
        "whole.csv",
        "--road",
        "net.geojson",
        "--session",
        "day=0.csv,1.csv",
    ];
    fuse(at, &[&whole[..], &["2.csv", "back.csv"]].concat()).success();
    let stored = [
        "--out",
        "map.csv",
        "--road",
        "net.geojson",
        "--store",
        "sums.csv",
    ];
    for run in [
        &["--session", "day=1.csv"][..],
        &["2.csv"],
        &["--session", "day=0.csv"],
        &["back.csv"],
    ] {
        fuse(at, &[&stored[..], run].concat()).success();
    }
    let (a, b) = ["whole.csv", "map.csv"]
        .map(|name| read_map_ways(&at.join(name)).expect(name))
        .into();
    assert_eq!(a.len(), b.len());
    for (a, b) in a.iter().zip(&b) {
        assert_eq!((&a.name, a.rows.len()), (&b.name, b.rows.len()));
        for (a, b) in a.rows.iter().zip(&b.rows) {
            assert!(
                (a.grade_percent - b.grade_percent).abs() < 2e-5,
                "{a:?} {b:?}"
            );
            assert_eq!(a.runs, b.runs);
        }
    }
    fuse(at, &[&stored[..], &["2.csv"]].concat())
        .success()
        .stderr(contains("already in the map"));

    // Without the network, and with another.
    let before = bytes(at, "sums.csv");
    fuse(at, &["--out", "no.csv", "--store", "sums.csv", "2.csv"])
        .failure()
        .code(1)
        .stderr(contains(
            "the store has a network; give the file of the network with --road",
        ));
    save(&at.join("other.geojson"), &three(&hills())[..2]);
    fuse(
        at,
        &[
            "--out",
            "no.csv",
            "--store",
            "sums.csv",
            "--road",
            "other.geojson",
            "2.csv",
        ],
    )
    .failure()
    .code(1)
    .stderr(contains("the store has another road"));
    // Rows of ways that are not in the store, or in another order.
    let text = String::from_utf8(before.clone()).expect("text");
    for (from, to, expected) in [
        (
            ",c,forward",
            ",d,forward",
            "a cell of a way that the rows before list",
        ),
        (",a,forward", ",z,forward", "ways out of order"),
        (",b,forward", ",b,sideways", "unknown variant `sideways`"),
        (",b,forward", ",,forward", "incomplete name of a way"),
    ] {
        let begin = if expected.contains("rows before") {
            text.find(",day,").expect("a session")
        } else {
            0
        };
        let (kept, changed) = text.split_at(begin);
        let damaged = format!("{kept}{}", changed.replace(from, to));
        std::fs::write(at.join("damaged.csv"), damaged).expect("written");
        let store = [
            "--out",
            "no.csv",
            "--road",
            "net.geojson",
            "--store",
            "damaged.csv",
        ];
        fuse(at, &[&store[..], &["2.csv"]].concat())
            .failure()
            .code(1)
            .stderr(contains("damaged.csv:").and(contains(expected)));
    }
    assert_eq!(bytes(at, "sums.csv"), before);
    assert!(!at.join("no.csv").exists());
}

#[test]
fn a_map_of_ways_is_no_single_road() {
    let folder = folder();
    let at = folder.path();
    drives(at);
    save(&at.join("net.geojson"), &three(&hills()));
    fuse(at, &["--out", "map.csv", "--road", "net.geojson", "0.csv"]).success();
    let problem = host_sim::map::read_map(&at.join("map.csv")).expect_err("three ways");
    assert!(
        problem
            .to_string()
            .contains("3 ways; expected a single road"),
        "{problem}"
    );
}

#[test]
fn names_and_directions_are_found_where_exports_have_them() {
    let folder = folder();
    let at = folder.path();
    drives(at);
    let line = way("x", "", &hills())["geometry"].clone();
    let feature =
        |properties: Value| json!({"type": "Feature", "properties": properties, "geometry": line});
    let mut parts = feature(json!({"osm_id": 12, "oneway": true}));
    parts["geometry"] = json!({"type": "MultiLineString", "coordinates": [line["coordinates"]]});
    let mut by_id = feature(json!({"oneway": "yes"}));
    by_id["id"] = json!("w7");
    let mut without = feature(Value::Null);
    without["id"] = json!(8);
    for (feature, expected) in [
        (
            feature(json!({"way": "A 1", "oneway": 1})),
            &["A 1 forward"][..],
        ),
        (
            feature(json!({"@id": "way/4", "oneway": "no"})),
            &["way/4 forward", "way/4 backward"],
        ),
        (feature(json!({"id": 4, "oneway": "-1"})), &["4 backward"]),
        (
            feature(json!({"way": "r", "junction": "roundabout"})),
            &["r forward"],
        ),
        (
            feature(json!({"way": "m", "highway": "motorway"})),
            &["m forward"],
        ),
        (
            feature(json!({"way": "m", "oneway": null})),
            &["m forward", "m backward"],
        ),
        (parts, &["12 forward"]),
        (by_id, &["w7 forward"]),
        (without, &["8 forward", "8 backward"]),
    ] {
        save(&at.join("net.geojson"), &[feature]);
        fuse(
            at,
            &[
                "--out",
                "map.csv",
                "--road",
                "net.geojson",
                "0.csv",
                "back.csv",
            ],
        )
        .success();
        let map = read_map_ways(&at.join("map.csv")).expect("a map");
        let names: Vec<String> = map
            .iter()
            .map(|way| way.name.as_ref().expect("a name").to_string())
            .collect();
        assert_eq!(names, expected);
    }
}

#[test]
fn a_file_that_is_no_network_is_refused_with_what_was_expected() {
    let folder = folder();
    let at = folder.path();
    drives(at);
    let good = way("a", "yes", &hills());
    let whole = collection(std::slice::from_ref(&good));
    for (text, expected) in [
        (String::new(), "net.geojson:1: EOF"),
        (whole[..whole.len() / 2].to_owned(), "net.geojson:1: EOF"),
        (whole.clone() + "{", "net.geojson:1: EOF"),
        (
            "way,distance_m\n".to_owned(),
            "net.geojson:1: expected value",
        ),
        ("[]".to_owned(), "expected a GeoJSON FeatureCollection"),
        (
            json!({"type": "FeatureCollection"}).to_string(),
            "missing field `features`",
        ),
        (json!({"features": []}).to_string(), "missing field `type`"),
        (
            json!({"type": "Topology", "features": []}).to_string(),
            "type \"Topology\"; expected FeatureCollection",
        ),
        (collection(&[]), "no features; expected LineStrings"),
    ] {
        std::fs::write(at.join("net.geojson"), &text).expect("written");
        fuse(at, &["--out", "map.csv", "--road", "net.geojson", "0.csv"])
            .failure()
            .code(1)
            .stdout("")
            .stderr(contains("net.geojson").and(contains(expected)));
        assert!(!at.join("map.csv").exists(), "{expected}");
    }
    fuse(at, &["--out", "map.csv", "--road", "none.geojson", "0.csv"])
        .failure()
        .code(1)
        .stderr(contains("none.geojson: "));
}

#[test]
fn a_bad_feature_costs_itself_alone() {
    let folder = folder();
    let path = folder.path().join("net.geojson");
    let good = way("a", "yes", &hills());
    let with = |change: &dyn Fn(&mut Value)| {
        let mut bad = way("b", "yes", &hills());
        change(&mut bad);
        bad
    };
    let line =
        |coordinates: Value| with(&move |way| way["geometry"]["coordinates"] = coordinates.clone());
    for (bad, expected) in [
        (json!(5), ": "),
        (json!({"type": "Feature"}), ": "),
        (
            with(&|way| way["properties"]["way"] = json!(["b"])),
            ": way is [\"b\"]; expected a text or a number",
        ),
        (
            with(&|way| way["properties"]["way"] = json!("")),
            ": way is \"\"",
        ),
        (
            with(&|way| way["properties"]["oneway"] = json!("perhaps")),
            ": way b: oneway is \"perhaps\"; expected yes, no or -1",
        ),
        (
            with(&|way| way["geometry"] = Value::Null),
            ": way b: no geometry; expected a LineString",
        ),
        (
            with(&|way| {
                way["geometry"] = json!({"type": "Point", "coordinates": [8.0, 47.0]});
            }),
            ": way b: a Point; expected a LineString",
        ),
        (line(json!([])), ": way b: 0 position(s) that differ"),
        (
            line(json!([[8.5, 47.4], [8.5, 47.4]])),
            ": way b: 1 position(s) that differ",
        ),
        (line(json!([[8.5, 47.4], [8.5]])), ": "),
        (line(json!([[8.5, 47.4], ["8.5", 47.4]])), ": "),
        (
            // Latitude first.
            line(json!([[8.5, 47.4], [8.5, 97.4]])),
            ": way b: position 2: latitude_deg is 97.4; expected degrees",
        ),
        (
            line(json!([[8.5, 47.4], [190.0, 47.4]])),
            ": way b: position 2: longitude_deg is 190",
        ),
        (
            line(json!([[8.5, 47.4], [20.0, 47.4]])),
            ": way b: point 0 is over 300 km from the middle",
        ),
    ] {
        for (features, place) in [
            ([good.clone(), bad.clone()], "feature 2"),
            ([bad.clone(), good.clone()], "feature 1"),
        ] {
            std::fs::write(&path, collection(&features)).expect("written");
            let network = read_network(&path).expect(expected);
            let names: Vec<_> = network.ways().iter().map(|way| way.name.as_ref()).collect();
            assert_eq!(names.len(), 1, "{expected}");
            assert_eq!(names[0].expect("a name").way, "a");
            // Alone, it is the error.
            std::fs::write(&path, collection(std::slice::from_ref(&bad))).expect("written");
            let problem = read_network(&path).expect_err(expected).to_string();
            let words = format!("net.geojson: feature 1{expected}");
            assert!(problem.contains(&words), "{place}: {problem}");
        }
    }
}

#[test]
fn what_is_left_out_is_counted_and_told() {
    let folder = folder();
    let at = folder.path();
    drives(at);
    let point = json!({"type": "Feature", "properties": {"way": "node/3"},
                       "geometry": {"type": "Point", "coordinates": [8.0, 47.0]}});
    let mut features = three(&hills());
    features.splice(1..1, vec![point; 7]);
    save(&at.join("net.geojson"), &features);
    fuse(at, &["--out", "map.csv", "--road", "net.geojson", "0.csv"])
        .success()
        .stderr(
            contains("net.geojson: left out 7 objects that are no ways:")
                .and(contains(
                    "  feature 2: way node/3: a Point; expected a LineString",
                ))
                .and(contains("feature 6: way node/3"))
                .and(contains("feature 7: ").not()),
        );
}

#[test]
fn ways_of_several_parts_and_of_one_name_are_kept() {
    let folder = folder();
    let path = folder.path().join("net.geojson");
    let names = |features: &[Value]| {
        save(&path, features);
        let network = read_network(&path).expect("a network");
        let name = |way: &host_sim::map::Way| {
            let name = way.name.as_ref().expect("a name");
            (name.to_string(), (length_m(way) / 10.0).round() as usize)
        };
        network.ways().iter().map(name).collect::<Vec<_>>()
    };
    let spots = hills();
    let line =
        |from: usize, to: usize| way("x", "", &spots[from..=to])["geometry"]["coordinates"].clone();
    let of = |name: &str, parts: Vec<Value>| {
        json!({"type": "Feature", "properties": {"way": name, "oneway": "yes"},
               "geometry": {"type": "MultiLineString", "coordinates": parts}})
    };
    // Parts that touch, in any order, are one way.
    for parts in [
        vec![line(0, 800), line(800, 1600)],
        vec![line(800, 1600), line(0, 800)],
    ] {
        assert_eq!(names(&[of("a", parts)]), [("a forward".to_owned(), 400)]);
    }
    // Others are ways of their own, and an empty one is none.
    let apart = vec![line(0, 400), json!([]), line(800, 1600)];
    let expected = [
        ("a forward".to_owned(), 100),
        ("a#2 forward".to_owned(), 200),
    ];
    assert_eq!(names(&[of("a", apart)]), expected);
    // Pieces of one name, as routable networks have them; the same piece twice is one.
    let pieces = [
        of("a", vec![line(0, 400)]),
        of("a", vec![line(800, 1600)]),
        of("a", vec![line(0, 400)]),
    ];
    assert_eq!(names(&pieces), expected);
    // Without a name, a way has the number of its feature.
    let mut nameless = of("a", vec![line(0, 400)]);
    nameless["properties"] = json!({"oneway": "yes"});
    let expected = [("feature 1 forward".to_owned(), 100)];
    assert_eq!(names(&[nameless]), expected);
}
