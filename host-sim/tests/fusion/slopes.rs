//! `roadgrade export` of slopes: edges, inclines, elevation tiles and altitudes of nodes.

use super::save as save_map;
use assert_cmd::assert::Assert;
use geojson::{FeatureCollection, Value as Shape};
use host_sim::map::{MapRow, Network, WayDirection, WayRows, read_network};
use host_sim::source::terrain::Terrain;
use predicates::prelude::*;
use predicates::str::contains;
use std::collections::BTreeMap;
use std::path::Path;
use test_kit::command::{folder, roadgrade};
use test_kit::osm::{Packing, pbf};
use test_kit::roads::network::{osm_nodes, way};
use test_kit::roads::{Spot, drive};

const SIGMA_PERCENT: f64 = 0.1;
/// Distances at which the road changes its grade, m, and the grades from there on, %.
const GRADES: [(f64, f64); 4] = [(0.0, 0.0), (1000.0, 6.0), (2000.0, -4.0), (3000.0, 0.0)];

fn export(folder: &Path, arguments: &[&str]) -> Assert {
    roadgrade(folder, &[&["export"][..], arguments].concat())
}

fn grade_percent(at_m: f64) -> f64 {
    GRADES
        .iter()
        .rev()
        .find(|(from_m, _)| at_m >= *from_m)
        .expect("in order")
        .1
}

/// Returns a road of 4 km whose grade changes at 1, 2 and 3 km.
fn spots() -> Vec<Spot> {
    drive((0.0, 0.0), 4000.0, |_| 20.0, grade_percent)
}

/// Writes net.osm.pbf: way 1 from 0 to 1.5 km, a bridge in both directions from there to 2.5 km,
/// and way 3 against its points to the end.
fn write_network(folder: &Path) -> Network {
    let spots = spots();
    let mut reversed = spots[1000..].to_vec();
    reversed.reverse();
    let ways = [
        way("way/1", "yes", &spots[..=600]),
        way("way/2", "no", &spots[600..=1000]),
        way("way/3", "-1", &reversed),
    ];
    let (mut nodes, mut of_ways) = osm_nodes(&ways);
    nodes[0].3 = &[("highway", "crossing"), ("note", "a \"quote\" & <more>")];
    let third = of_ways.pop().expect("three");
    let second = of_ways.pop().expect("three");
    let first = of_ways.pop().expect("three");
    let bytes = pbf(
        &["OsmSchema-V0.6", "DenseNodes"],
        &nodes,
        &[
            (1, first, &[("highway", "primary"), ("oneway", "yes")]),
            (2, second, &[("highway", "primary"), ("bridge", "yes")]),
            (3, third, &[("highway", "primary"), ("oneway", "-1")]),
        ],
        Packing::Zlib,
    );
    let path = folder.join("net.osm.pbf");
    std::fs::write(&path, bytes).expect("written");
    read_network(&path).expect("a network")
}

/// Returns the map of all ways in this direction of the spots, or of all directions.
fn rows(network: &Network, drawn: impl Fn(&str, WayDirection) -> bool) -> Vec<WayRows> {
    let spots = spots();
    let starts_m = BTreeMap::from([("way/1", 0.0), ("way/2", 1500.0), ("way/3", 2500.0)]);
    let mut map = Vec::new();
    for way in network.ways() {
        let name = way.name.clone().expect("a name");
        if !drawn(&name.way, name.direction) {
            continue;
        }
        let length_m = way.line.end_m();
        // Lengths on the slope are longer than those in plan.
        let driven_m: f64 = if name.way == "way/2" { 1000.0 } else { 1500.0 };
        // Way 3 has its points against the spots.
        let against = (name.direction == WayDirection::Backward) != (name.way == "way/3");
        let rows = way.line.on_grid().into_iter().map(|point| {
            let part = point.distance_m / length_m;
            let part = if against { 1.0 - part } else { part };
            let at_m = starts_m[&*name.way] + part * driven_m;
            let sign = if against { -1.0 } else { 1.0 };
            MapRow {
                distance_m: point.distance_m,
                latitude_deg: point.latitude_deg,
                longitude_deg: point.longitude_deg,
                altitude_m: Some(spots[(at_m / 2.5).round() as usize].altitude_m),
                grade_percent: sign * grade_percent(at_m),
                grade_sigma_percent: SIGMA_PERCENT,
                runs: 3,
            }
        });
        map.push(WayRows {
            rows: rows.collect(),
            name: Some(name),
        });
    }
    map
}

fn table(path: &Path) -> Vec<BTreeMap<String, String>> {
    let mut reader = csv::Reader::from_path(path).expect("a table");
    reader
        .deserialize()
        .map(|row| row.expect("a row"))
        .collect()
}

fn number(row: &BTreeMap<String, String>, column: &str) -> f64 {
    row[column]
        .parse()
        .unwrap_or_else(|_| panic!("{column}: {row:?}"))
}

#[test]
fn edges_have_the_slopes_of_their_direction() {
    let folder = folder();
    let at = folder.path();
    let network = write_network(at);
    // Nothing drove way 3; way 2 was driven forward alone.
    let map = rows(&network, |way, direction| {
        way != "way/3" && direction == WayDirection::Forward
    });
    save_map(at, "map.csv", &map);
    let arguments = [
        "map.csv",
        "--road",
        "net.osm.pbf",
        "--format",
        "edges",
        "--out",
        "e.csv",
    ];
    export(at, &arguments)
        .success()
        .stderr(contains("4 edges, 3 with slopes"));
    let edges = table(&at.join("e.csv"));
    let of = |way: &str, direction: &str| {
        let found = edges
            .iter()
            .find(|e| e["way"] == way && e["direction"] == direction);
        found.unwrap_or_else(|| panic!("{way} {direction}: {edges:?}"))
    };
    let is = |edge: &BTreeMap<String, String>, column: &str, expected: f64| {
        let value = number(edge, column);
        assert!(
            (value - expected).abs() < 0.05,
            "{column}: {value}, {edge:?}"
        );
    };
    let first = of("way/1", "forward");
    is(first, "average_grade_percent", 2.0);
    is(first, "largest_up_percent", 6.0);
    is(first, "largest_down_percent", 0.0);
    is(first, "grade_sigma_percent", 0.1);
    is(first, "covered_percent", 100.0);
    assert_eq!(
        (&*first["structure"], &*first["from_other_direction"]),
        ("", "0")
    );

    let bridge = of("way/2", "forward");
    is(bridge, "average_grade_percent", 1.0);
    is(bridge, "largest_up_percent", 6.0);
    is(bridge, "largest_down_percent", -4.0);
    assert_eq!(bridge["structure"], "bridge");
    let back = of("way/2", "backward");
    is(back, "average_grade_percent", -1.0);
    is(back, "largest_up_percent", 4.0);
    is(back, "largest_down_percent", -6.0);
    assert_eq!(back["from_other_direction"], "1");
    assert_eq!(
        (&bridge["from_latitude_deg"], &bridge["to_longitude_deg"]),
        (&back["to_latitude_deg"], &back["from_longitude_deg"])
    );

    let unknown = of("way/3", "backward");
    is(unknown, "covered_percent", 0.0);
    assert_eq!(
        (&*unknown["average_grade_percent"], &*unknown["runs"]),
        ("", "0")
    );
}

/// Proposals: way, from and to (m), incline.
type Proposals = Vec<(String, f64, f64, String)>;

fn proposals(path: &Path) -> Proposals {
    let text = std::fs::read_to_string(path).expect("text");
    let collection: FeatureCollection = text.parse().expect("GeoJSON");
    let of = |feature: geojson::Feature| {
        let geometry = feature.geometry.as_ref().map(|geometry| &geometry.value);
        assert!(matches!(geometry, Some(Shape::LineString(points)) if points.len() >= 2));
        let text = |key: &str| {
            feature
                .property(key)
                .and_then(|v| v.as_str())
                .expect("text")
        };
        let number = |key: &str| {
            feature
                .property(key)
                .and_then(|v| v.as_f64())
                .expect("number")
        };
        let incline = text("incline").to_owned();
        (
            text("way").to_owned(),
            number("from_m"),
            number("to_m"),
            incline,
        )
    };
    collection.features.into_iter().map(of).collect()
}

#[test]
fn inclines_are_signed_along_the_way_and_split_where_the_grade_changes() {
    let folder = folder();
    let at = folder.path();
    let network = write_network(at);
    save_map(at, "map.csv", &rows(&network, |_, _| true));
    let arguments = [
        "map.csv",
        "--road",
        "net.osm.pbf",
        "--format",
        "inclines",
        "--out",
    ];
    export(at, &[&arguments[..], &["i.geojson"]].concat())
        .success()
        .stderr(contains("4 proposals, 2.0 km; for a person to review"));
    let found = proposals(&at.join("i.geojson"));
    let expected = [
        ("way/1", 1000.0, 1500.0, "6%"),
        ("way/2", 0.0, 500.0, "6%"),
        ("way/2", 500.0, 1000.0, "-4%"),
        // The points of way 3 lead against the drive: what it drove down is up along the way.
        ("way/3", 1000.0, 1500.0, "4%"),
    ];
    assert_eq!(found.len(), expected.len(), "{found:?}");
    for (found, expected) in found.iter().zip(expected) {
        assert_eq!(
            (&*found.0, &*found.3),
            (expected.0, expected.3),
            "{found:?}"
        );
        // Sections end at parts of 25 m.
        assert!((found.1 - expected.1).abs() < 27.0, "{found:?}");
        assert!((found.2 - expected.2).abs() < 27.0, "{found:?}");
    }
    export(at, &[&arguments[..], &["i.osm"]].concat()).success();
    let text = std::fs::read_to_string(at.join("i.osm")).expect("text");
    assert!(
        text.contains("<osm version=\"0.6\" upload=\"never\""),
        "{text}"
    );
    assert_eq!(text.matches("<way id=\"-").count(), 4);
    assert_eq!(text.matches("<tag k=\"incline\" v=\"6%\"/>").count(), 2);
}

#[test]
fn no_incline_is_proposed_where_the_map_is_not_sure() {
    let folder = folder();
    let at = folder.path();
    let network = write_network(at);
    let all = rows(&network, |_, _| true);
    let found = |name: &str, map: &[WayRows], more: &[&str]| {
        save_map(at, name, map);
        let arguments = [
            name,
            "--road",
            "net.osm.pbf",
            "--format",
            "inclines",
            "--out",
            "i.json",
        ];
        export(at, &[&arguments[..], more].concat()).success();
        proposals(&at.join("i.json"))
    };
    // Beyond the limit, on way 1 alone.
    let mut unsure = all.clone();
    for row in &mut unsure[0].rows {
        row.grade_sigma_percent = 0.3;
    }
    let ways = |found: &Proposals| found.iter().map(|p| p.0.clone()).collect::<Vec<_>>();
    assert_eq!(
        ways(&found("unsure.csv", &unsure, &[])),
        ["way/2", "way/2", "way/3"]
    );
    let more = ["--sigma-limit", "0.3"];
    assert_eq!(found("unsure.csv", &unsure, &more).len(), 4);
    assert_eq!(
        found("unsure.csv", &unsure, &["--sigma-limit", "0.09"]).len(),
        0
    );
    // Both directions of way 2 contradict each other.
    let mut contradicted = all.clone();
    for row in &mut contradicted[2].rows {
        row.grade_percent += 1.0;
    }
    assert_eq!(
        ways(&found("two.csv", &contradicted, &[])),
        ["way/1", "way/3"]
    );
    // A hole in the middle: the rest is too short.
    let mut hole = all;
    hole.truncate(1);
    hole[0]
        .rows
        .retain(|row| !(1080.0..1420.0).contains(&row.distance_m));
    assert_eq!(found("hole.csv", &hole, &[]).len(), 0);
}

#[test]
fn elevation_tiles_give_the_slopes_back() {
    let folder = folder();
    let at = folder.path();
    let network = write_network(at);
    let map = rows(&network, |_, _| true);
    save_map(at, "map.csv", &map);
    export(at, &["map.csv", "--format", "hgt", "--out", "tiles"])
        .success()
        .stderr(contains("tiles: 1 tiles, ").and(contains(" 0 of them shared")));
    let mut terrain = Terrain::new(&at.join("tiles/N47"));
    let rows = &map[0].rows;
    let mut altitude_m = |row: &MapRow| {
        let read = terrain.altitude_m(row.latitude_deg, row.longitude_deg);
        read.expect("a tile").expect("an altitude")
    };
    for row in rows.iter().step_by(7) {
        let error_m = altitude_m(row) - row.altitude_m.expect("known");
        assert!(error_m.abs() < 1.6, "{error_m} m at {} m", row.distance_m);
    }
    // From 1.1 to 1.4 km at 6 %: whole metres cost at most 0.3 %.
    let climb_m = altitude_m(&rows[560]) - altitude_m(&rows[440]);
    assert!((climb_m / 3.0 - 6.0).abs() < 0.35, "{climb_m}");
    // Beside the road nothing is known; with terrain it is.
    let mut beside = Terrain::new(&at.join("tiles/N47"));
    assert_eq!(beside.altitude_m(47.9, 8.9).expect("a tile"), None);
    let flat: Vec<u8> = [0, 123].repeat(1201 * 1201);
    std::fs::write(at.join("N47E008.hgt"), flat).expect("written");
    let with = [
        "map.csv",
        "--format",
        "hgt",
        "--terrain",
        ".",
        "--out",
        "tiles",
    ];
    export(at, &with).success();
    let mut beside = Terrain::new(&at.join("tiles/N47"));
    assert_eq!(beside.altitude_m(47.9, 8.9).expect("a tile"), Some(123.0));
}

#[test]
fn nodes_get_the_altitude_and_keep_their_tags() {
    let folder = folder();
    let at = folder.path();
    let network = write_network(at);
    let map = rows(&network, |way, _| way != "way/3");
    save_map(at, "map.csv", &map);
    export(
        at,
        &["map.csv", "--road", "net.osm.pbf", "--out", "ele.osc"],
    )
    .success();
    let text = std::fs::read_to_string(at.join("ele.osc")).expect("text");
    assert!(text.contains("<osmChange version=\"0.6\""), "{text}");
    // The first node: 400 m, as the road begins.
    let first = text
        .split("</node>")
        .find(|node| node.contains("id=\"9000000000\""));
    let first = first.expect("the first node");
    assert!(first.contains("version=\"1\""), "{first}");
    assert!(first.contains("<tag k=\"ele\" v=\"400.00\"/>"), "{first}");
    assert!(
        first.contains("v=\"a &quot;quote&quot; &amp; &lt;more&gt;\""),
        "{first}"
    );
    // One node every 20 m, 126 on the first two ways.
    assert_eq!(text.matches("k=\"ele\"").count(), 126, "{text}");
}

#[test]
fn what_the_slopes_need_is_told() {
    let folder = folder();
    let at = folder.path();
    let network = write_network(at);
    save_map(at, "map.csv", &rows(&network, |_, _| true));
    let other = rows(&network, |way, _| way == "way/1");
    let mut other = other[0].clone();
    other.name.as_mut().expect("a name").way = "way/9".to_owned();
    save_map(at, "other.csv", &[other]);
    let inclines = ["--format", "inclines", "--out", "i.geojson"];
    let with = |map: &'static str, more: &[&'static str]| [&[map][..], &inclines, more].concat();
    let usage = [
        (with("map.csv", &[]), "expected --road ROAD"),
        (
            with("map.csv", &["--sigma-limit=-1"]),
            "expected more than 0 %",
        ),
        (
            with("map.csv", &["--terrain", "."]),
            "--terrain applies to --format hgt",
        ),
        (
            vec!["map.csv", "--out", "x.geojson", "--road", "net.osm.pbf"],
            "--road applies to --format edges, inclines and ele",
        ),
    ];
    for (arguments, expected) in usage {
        export(at, &arguments)
            .failure()
            .code(2)
            .stderr(contains(expected));
    }
    export(at, &with("other.csv", &["--road", "net.osm.pbf"]))
        .failure()
        .code(1)
        .stderr(contains(
            "other.csv: has way way/9 forward, which the network lacks; expected",
        ));
    assert!(!at.join("i.geojson").exists());
}
