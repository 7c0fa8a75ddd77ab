//! Networks from OpenStreetMap extracts: what is read, and what is refused.

use assert_cmd::assert::Assert;
use host_sim::files::run;
use host_sim::map::{Structure, read_network};
use predicates::prelude::*;
use predicates::str::contains;
use serde_json::{Value, json};
use std::path::{Path, PathBuf};
use test_kit::command::{folder, roadgrade};
use test_kit::osm::{OsmNode, OsmWay, Packing, pbf, pbf_with_locations};
use test_kit::roads::network::{osm_nodes, save, way};
use test_kit::roads::{Spot, hills, with_position_noise};

const FEATURES: [&str; 2] = ["OsmSchema-V0.6", "DenseNodes"];
const PRIMARY: [(&str, &str); 1] = [("highway", "primary")];

fn fuse(folder: &Path, arguments: &[&str]) -> Assert {
    roadgrade(folder, &[&["fuse"][..], arguments].concat())
}

/// Returns the hills in two ways that share a point.
fn two(spots: &[Spot]) -> [Value; 2] {
    [
        way("way/11", "yes", &spots[..=800]),
        way("way/12", "no", &spots[800..]),
    ]
}

fn extract(packing: Packing) -> Vec<u8> {
    of_hills(|nodes, ways| pbf(&FEATURES, nodes, ways, packing))
}

/// Returns the hills as an extract that `write` makes of nodes and ways.
fn of_hills(write: impl FnOnce(&[OsmNode<'_>], &[OsmWay<'_>]) -> Vec<u8>) -> Vec<u8> {
    let (nodes, mut of_ways) = osm_nodes(&two(&hills()));
    let [second, first] = [of_ways.pop(), of_ways.pop()].map(|way| way.expect("two ways"));
    let ways: [OsmWay; 3] = [
        (11, first, &[("highway", "trunk_link"), ("oneway", "yes")]),
        (
            12,
            second.clone(),
            &[("bridge", "viaduct"), ("highway", "primary")],
        ),
        (
            13,
            second,
            &[("highway", "footway"), ("oneway", "sometimes")],
        ),
    ];
    write(&nodes, &ways)
}

fn file(folder: &Path, bytes: &[u8]) -> PathBuf {
    let path = folder.join("net.osm.pbf");
    std::fs::write(&path, bytes).expect("written");
    path
}

#[test]
fn an_extract_makes_the_map_that_the_same_ways_in_geojson_make() {
    let folder = folder();
    let at = folder.path();
    let rows = test_kit::roads::run(&with_position_noise(&hills(), 3.0, 80.0, 1));
    run::write(&at.join("run.csv"), &rows).expect("written");
    save(&at.join("net.geojson"), &two(&hills()));
    fuse(
        at,
        &["--out", "expected.csv", "--road", "net.geojson", "run.csv"],
    )
    .success();
    let forms = [
        extract(Packing::Raw),
        extract(Packing::Zlib),
        of_hills(pbf_with_locations),
    ];
    for (number, form) in forms.iter().enumerate() {
        file(at, form);
        fuse(
            at,
            &["--out", "map.csv", "--road", "net.osm.pbf", "run.csv"],
        )
        .success()
        .stderr(contains("6.00 km on 2 ways"));
        let [map, expected] = ["map.csv", "expected.csv"]
            .map(|name| std::fs::read_to_string(at.join(name)).expect(name));
        assert!(map.contains("\nway/12,forward,"), "{}", &map[..300]);
        assert_eq!(map, expected, "form {number}");
    }
}

#[test]
fn altitudes_are_put_on_nodes_only_where_the_extract_has_them() {
    let folder = folder();
    let at = folder.path();
    let rows = test_kit::roads::run(&hills());
    run::write(&at.join("run.csv"), &rows).expect("written");
    file(at, &of_hills(pbf_with_locations));
    let network = ["--road", "net.osm.pbf", "--out"];
    fuse(at, &[&network[..], &["map.csv", "run.csv"]].concat()).success();
    let export = [&["export", "map.csv"], &network[..], &["ele.osc"]].concat();
    roadgrade(at, &export)
        .failure()
        .code(1)
        .stderr(contains("net.osm.pbf: no elements for").and(contains("--keep-untagged-nodes")));
    assert!(!at.join("ele.osc").exists());
}

#[test]
fn structures_stay_with_their_ways() {
    let folder = folder();
    let path = file(folder.path(), &extract(Packing::Zlib));
    let network = read_network(&path).expect("a network");
    assert_eq!(network.structure("way/11"), None);
    assert_eq!(network.structure("way/12"), Some(Structure::Bridge));
    // A footway is no road.
    let names: Vec<_> = network.ways().iter().map(|way| way.name.as_ref()).collect();
    let shown: Vec<_> = names.iter().flatten().map(ToString::to_string).collect();
    assert_eq!(
        shown,
        ["way/11 forward", "way/12 forward", "way/12 backward"]
    );

    let mut ways = two(&hills());
    ways[0]["properties"]["tunnel"] = json!(true);
    ways[1]["properties"]["bridge"] = json!("no");
    let path = folder.path().join("net.geojson");
    save(&path, &ways);
    let network = read_network(&path).expect("a network");
    assert_eq!(network.structure("way/11"), Some(Structure::Tunnel));
    assert_eq!(network.structure("way/12"), None);

    ways[0]["properties"] = json!({"way": "way/11", "embankment": "left", "tunnel": ""});
    ways[1]["properties"] = json!({"way": "way/12", "cutting": true, "embankment": "both"});
    save(&path, &ways);
    let network = read_network(&path).expect("a network");
    assert_eq!(network.structure("way/11"), Some(Structure::Embankment));
    assert_eq!(network.structure("way/12"), Some(Structure::Cutting));
}

#[test]
fn an_extract_that_is_cut_off_is_refused_wherever_it_is_cut() {
    let folder = folder();
    let whole = extract(Packing::Zlib);
    let path = file(folder.path(), &whole);
    read_network(&path).expect("the whole file");
    for length in 0..whole.len() {
        std::fs::write(&path, &whole[..length]).expect("written");
        let problem = read_network(&path).expect_err("cut off").to_string();
        assert!(
            problem.contains("net.osm.pbf") && problem.contains("; expected "),
            "{length}: {problem}"
        );
    }
    file(folder.path(), &whole[..whole.len() / 2]);
    fuse(
        folder.path(),
        &["--out", "map.csv", "--road", "net.osm.pbf", "run.csv"],
    )
    .failure()
    .code(1)
    .stdout("")
    .stderr(contains("net.osm.pbf: block 2: ").and(contains("expected a whole")));
    assert!(!folder.path().join("map.csv").exists());
}

#[test]
fn damaged_bytes_are_an_error_or_another_network() {
    let folder = folder();
    let path = folder.path().join("net.osm.pbf");
    for packing in [Packing::Raw, Packing::Zlib] {
        let whole = extract(packing);
        let mut errors = 0;
        for at in (0..whole.len()).step_by(11) {
            let mut damaged = whole.clone();
            damaged[at] ^= 0xff;
            std::fs::write(&path, damaged).expect("written");
            if let Err(e) = read_network(&path) {
                assert!(e.to_string().contains("; expected "), "{at}: {e}");
                errors += 1;
            }
        }
        assert!(errors > 50, "{packing:?}: {errors}");
    }
}

#[test]
fn what_is_no_network_is_refused_with_what_was_expected() {
    let folder = folder();
    let at = folder.path();
    let place: [OsmNode; 2] = [
        (1, 474_000_000, 85_000_000, &[]),
        (2, 474_010_000, 85_000_000, &[]),
    ];
    let with =
        |nodes: &[OsmNode<'_>], ways: &[OsmWay<'_>]| pbf(&FEATURES, nodes, ways, Packing::Zlib);
    let cases = [
        (
            pbf(&["HistoricalInformation"], &place, &[], Packing::Raw),
            "requires \"HistoricalInformation\"; expected an extract of the present state",
        ),
        (
            with(&place, &[(5, vec![1, 2], &[("highway", "path")])]),
            "no roads; expected ways with a highway for vehicles",
        ),
        (
            with(&place, &[(5, vec![1, 3], &PRIMARY)]),
            "way/5: no node 3; expected an extract with complete ways",
        ),
        (
            with(&place, &[(5, vec![1, 1], &PRIMARY)]),
            "way/5: fewer than two nodes; expected a line",
        ),
        (
            with(
                &[place[0], (2, 974_000_000, 85_000_000, &[])],
                &[(5, vec![1, 2], &PRIMARY)],
            ),
            "node 2: latitude_deg is 97.4; expected ",
        ),
        (
            with(
                &place,
                &[(
                    5,
                    vec![1, 2],
                    &[("highway", "primary"), ("oneway", "maybe")],
                )],
            ),
            "way/5: oneway is \"maybe\"; expected yes, no or -1",
        ),
        (
            b"<?xml version='1.0'?>\n<osm version=\"0.6\"></osm>".to_vec(),
            "no roads; expected ways with a highway for vehicles",
        ),
        (
            b"distance_m,latitude_deg,longitude_deg\n".to_vec(),
            "is a road; expected an OpenStreetMap extract",
        ),
        (
            Vec::new(),
            "no blocks; expected a whole OpenStreetMap extract",
        ),
    ];
    for (bytes, expected) in cases {
        let path = file(at, &bytes);
        let problem = read_network(&path).expect_err(expected).to_string();
        assert!(problem.contains(expected), "{problem}");
    }
    // The content tells what the name does not.
    let bytes = with(&place, &[(5, vec![1, 2], &PRIMARY)]);
    std::fs::write(at.join("roads"), bytes).expect("written");
    let network = read_network(&at.join("roads")).expect("a network");
    assert_eq!(network.ways().len(), 2);
    fuse(at, &["--out", "map.csv", "roads"])
        .failure()
        .stderr(contains(
            "is an OpenStreetMap extract (.osm.pbf); expected a run",
        ));
}

#[test]
fn a_bad_way_or_node_costs_itself_alone() {
    let folder = folder();
    let at = folder.path();
    let (nodes, ways) = osm_nodes(&two(&hills()));
    let first = ways[0].clone();
    let good = |more: &[OsmWay<'_>]| {
        let ways = [&[(11, first.clone(), &PRIMARY[..])][..], more].concat();
        pbf(&FEATURES, &nodes, &ways, Packing::Zlib)
    };
    let maybe = [("highway", "primary"), ("oneway", "maybe")];
    for (more, expected) in [
        (
            (5, vec![first[0]], &PRIMARY[..]),
            "way/5: fewer than two nodes",
        ),
        ((5, vec![first[0], -7], &PRIMARY[..]), "way/5: no node -7"),
        (
            (5, vec![first[0], first[1]], &maybe[..]),
            "way/5: oneway is",
        ),
        ((11, first.clone(), &PRIMARY[..]), "way/11: is there twice"),
    ] {
        let path = file(at, &good(&[more]));
        let network = read_network(&path).expect(expected);
        assert_eq!(network.ways().len(), 2, "{expected}");
        fuse(
            at,
            &["--out", "map.csv", "--road", "net.osm.pbf", "none.csv"],
        )
        .failure()
        .stderr(contains("none.csv"));
    }
    // A way that lacks a node within is cut there.
    let mut torn = first.clone();
    let middle = torn.len() / 2;
    torn[middle] = -7;
    let path = file(
        at,
        &pbf(&FEATURES, &nodes, &[(11, torn, &PRIMARY)], Packing::Zlib),
    );
    let network = read_network(&path).expect("two parts");
    let shown: Vec<String> = network
        .ways()
        .iter()
        .map(|way| way.name.as_ref().expect("a name").to_string())
        .collect();
    let expected = [
        "way/11 forward",
        "way/11 backward",
        "way/11#2 forward",
        "way/11#2 backward",
    ];
    assert_eq!(shown, expected);
}
