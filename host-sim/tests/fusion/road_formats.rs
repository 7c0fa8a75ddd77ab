//! Roads in the forms that other programs write: GPX, KML, OpenStreetMap XML, sequences of GeoJSON.

use flate2::Compression;
use flate2::write::GzEncoder;
use host_sim::map::{Network, read_network};
use serde_json::{Value, json};
use std::fmt::Write as _;
use std::io::Write as _;
use std::path::Path;
use test_kit::archive::zip;
use test_kit::command::folder;
use test_kit::roads::hills;
use test_kit::roads::network::{collection, way};

fn network(folder: &Path, name: &str, text: impl AsRef<[u8]>) -> Network {
    let path = folder.join(name);
    std::fs::write(&path, text).expect("written");
    read_network(&path).expect(name)
}

/// Returns the names of the ways and their lengths, m.
fn ways(network: &Network) -> Vec<(String, usize)> {
    let way = |way: &host_sim::map::Way| {
        let name = way.name.as_ref().expect("a name");
        (name.to_string(), length_m(way).round() as usize)
    };
    network.ways().iter().map(way).collect()
}

/// Longitude and latitude of the hills, deg.
fn positions() -> Vec<(f64, f64)> {
    let positions = hills().into_iter().step_by(10).map(|spot| {
        let (latitude, longitude) = spot.latitude_longitude_deg();
        (longitude, latitude)
    });
    positions.collect()
}

const BOTH: [(&str, usize); 2] = [("road forward", 5998), ("road backward", 5998)];

fn assert_is_road(found: &[(String, usize)], name: &str) {
    assert_eq!(found.len(), 2, "{found:?}");
    for (found, (expected, length)) in found.iter().zip(BOTH) {
        assert_eq!(found.0, expected.replace("road", name));
        assert!(found.1.abs_diff(length) < 30, "{found:?}");
    }
}

fn length_m(way: &host_sim::map::Way) -> f64 {
    way.line.end_m()
}

#[test]
fn gpx_tracks_and_routes_are_ways() {
    let folder = folder();
    let at = folder.path();
    let points = |tag: &str, positions: &[(f64, f64)]| {
        let mut text = String::new();
        for (longitude, latitude) in positions {
            writeln!(
                text,
                "<{tag} lat=\"{latitude:.7}\" lon=\"{longitude:.7}\"><ele>4.5</ele><name>p</name></{tag}>"
            )
            .unwrap();
        }
        text
    };
    let all = positions();
    let head = "<?xml version=\"1.0\"?>\n<gpx version=\"1.1\" xmlns=\"http://www.topografix.com/GPX/1/1\">\n\
        <wpt lat=\"47\" lon=\"8\"><name>home</name></wpt>\n";
    let whole = format!(
        "{head}<trk><name>road</name><trkseg>{}</trkseg></trk></gpx>",
        points("trkpt", &all)
    );
    for name in ["road.gpx", "road", "road.xml"] {
        assert_is_road(&ways(&network(at, name, &whole)), "road");
    }
    // Segments that touch, and a route without a name.
    let (one, two) = (&all[..=100], &all[100..]);
    let parts = format!(
        "{head}<trk><name>road</name><trkseg>{}</trkseg><trkseg>{}</trkseg></trk></gpx>",
        points("trkpt", one),
        points("trkpt", two)
    );
    assert_is_road(&ways(&network(at, "parts.gpx", &parts)), "road");
    let route = format!(
        "{head}<rte>{}</rte><trk><trkseg/></trk></gpx>",
        points("rtept", &all)
    );
    assert_is_road(&ways(&network(at, "route.gpx", &route)), "track 1");
    for (text, expected) in [
        (
            whole[..whole.len() / 2].to_owned(),
            "expected a whole XML file",
        ),
        (
            format!("{head}</gpx>"),
            "no track and no route; expected at least one",
        ),
        (
            format!("{head}<trk><trkseg/></trk></gpx>"),
            "track 1, track 1: ",
        ),
        (
            format!(
                "{head}<trk><trkseg>{}</trkseg></trk></gpx>",
                points("trkpt", &[(8.0, 97.0)])
            ),
            "latitude_deg is 97",
        ),
    ] {
        std::fs::write(at.join("bad.gpx"), text).expect("written");
        let problem = read_network(&at.join("bad.gpx"))
            .expect_err(expected)
            .to_string();
        assert!(problem.contains(expected), "{problem}");
    }
}

#[test]
fn kml_lines_are_ways() {
    let folder = folder();
    let at = folder.path();
    let all = positions();
    let coordinates: Vec<String> = all
        .iter()
        .map(|(longitude, latitude)| format!("{longitude:.7},{latitude:.7},4.5"))
        .collect();
    let tracks: String = all
        .iter()
        .map(|(longitude, latitude)| {
            format!("<gx:coord>{longitude:.7} {latitude:.7} 4.5</gx:coord>")
        })
        .collect();
    let head = "<?xml version=\"1.0\"?>\n<kml xmlns=\"http://www.opengis.net/kml/2.2\"><Document><name>d</name>";
    let line = format!(
        "<LineString><tessellate>1</tessellate><coordinates>\n{}\n</coordinates></LineString>",
        coordinates.join("\n  ")
    );
    let point =
        "<Placemark><name>home</name><Point><coordinates>8,47,0</coordinates></Point></Placemark>";
    for geometry in [
        line.clone(),
        format!("<MultiGeometry>{line}</MultiGeometry>"),
        format!("<gx:Track>{tracks}</gx:Track>"),
    ] {
        let text = format!(
            "{head}{point}<Placemark><name>road</name>{geometry}</Placemark></Document></kml>"
        );
        assert_is_road(&ways(&network(at, "road.kml", &text)), "road");
    }
    let none = format!("{head}{point}</Document></kml>");
    std::fs::write(at.join("bad.kml"), none).expect("written");
    let problem = read_network(&at.join("bad.kml"))
        .expect_err("a point")
        .to_string();
    assert!(
        problem.contains("placemark 1, home: no line; expected a line"),
        "{problem}"
    );
}

#[test]
fn openstreetmap_xml_gives_the_roads_of_the_extract() {
    let folder = folder();
    let at = folder.path();
    let mut text = "<?xml version='1.0' encoding='UTF-8'?>\n<osm version='0.6'>\n".to_owned();
    let all = positions();
    for (id, (longitude, latitude)) in (1..).zip(&all) {
        writeln!(
            text,
            "<node id='{id}' lat='{latitude:.7}' lon='{longitude:.7}'/>"
        )
        .unwrap();
    }
    let refs: String = (1..=all.len())
        .map(|id| format!("<nd ref='{id}'/>"))
        .collect();
    let road =
        "<tag k='highway' v='primary'/><tag k='name' v='A &amp; B'/><tag k='bridge' v='yes'/>";
    writeln!(text, "<way id='7'>{refs}{road}</way>").unwrap();
    writeln!(
        text,
        "<way id='8'>{refs}<tag k='highway' v='footway'/></way>"
    )
    .unwrap();
    writeln!(text, "<way id='9'><nd ref='1'/>{road}</way>").unwrap();
    writeln!(text, "<way id='10' visible='false'>{refs}{road}</way>").unwrap();
    text += "</osm>\n";
    let mut packed = GzEncoder::new(Vec::new(), Compression::default());
    packed.write_all(text.as_bytes()).unwrap();
    let packed = packed.finish().unwrap();
    for (name, content) in [
        ("net.osm", text.as_bytes()),
        ("net.osm.gz", &packed),
        ("net", text.as_bytes()),
    ] {
        let network = network(at, name, content);
        assert_is_road(&ways(&network), "way/7");
        assert!(network.structure("way/7").is_some());
    }
    std::fs::write(at.join("cut.osm"), &text[..text.len() / 2]).expect("written");
    let problem = read_network(&at.join("cut.osm"))
        .expect_err("cut off")
        .to_string();
    assert!(problem.contains("expected a whole XML file"), "{problem}");
}

#[test]
fn single_features_and_sequences_of_geojson_are_networks() {
    let folder = folder();
    let at = folder.path();
    let spots = hills();
    let features: [Value; 2] = [
        way("a", "yes", &spots[..=800]),
        way("b", "yes", &spots[800..]),
    ];
    let names = |name: &str, text: String| {
        let found = ways(&network(at, name, text));
        found.into_iter().map(|(name, _)| name).collect::<Vec<_>>()
    };
    let whole = collection(&features);
    let marked = format!("\u{feff}{whole}");
    let lines = format!("{}\n{}\n", features[0], features[1]);
    let records = format!("\u{1e}{}\n\u{1e}{}\n", features[0], features[1]);
    let two = format!("{whole}\n{}", collection(&[way("c", "yes", &spots[..=80])]));
    for (name, text, expected) in [
        ("a.geojson", whole.clone(), &["a forward", "b forward"][..]),
        ("marked.geojson", marked, &["a forward", "b forward"]),
        ("one.geojson", features[0].to_string(), &["a forward"]),
        ("lines.geojsonl", lines.clone(), &["a forward", "b forward"]),
        ("lines.ndjson", lines.clone(), &["a forward", "b forward"]),
        (
            "records.geojsons",
            records.clone(),
            &["a forward", "b forward"],
        ),
        ("records", records, &["a forward", "b forward"]),
        ("lines", lines, &["a forward", "b forward"]),
        ("two.json", two, &["a forward", "b forward", "c forward"]),
    ] {
        assert_eq!(names(name, text), expected, "{name}");
    }
}

#[test]
fn packed_roads_are_read() {
    let folder = folder();
    let at = folder.path();
    let line: Vec<String> = positions()
        .iter()
        .map(|(x, y)| format!("{x:.7},{y:.7}"))
        .collect();
    let kml = format!(
        "<kml><Placemark><name>road</name><LineString><coordinates>{}</coordinates></LineString>\
         </Placemark></kml>",
        line.join(" ")
    );
    let image = ("files/icon.png", &b"\x89PNG"[..]);
    let of = |files: &[(&str, &[u8])], has_sizes| zip(files, true, has_sizes);
    let kml = kml.as_bytes();
    let mac = ("__MACOSX/._road.kml", &b"\x00\x05"[..]);
    let style = ("styles/style.kml", &b"<kml/>"[..]);
    for (name, content) in [
        ("road.kmz", of(&[("doc.kml", kml), image], false)),
        ("behind.kmz", of(&[image, ("DOC.KML", kml)], true)),
        ("mac.zip", of(&[mac, ("road.kml", kml)], true)),
        ("style.kmz", of(&[style, ("doc.kml", kml)], true)),
    ] {
        assert_is_road(&ways(&network(at, name, content)), "road");
    }
    let geojson = collection(&[way("road", "no", &hills())]);
    let mut gzip = GzEncoder::new(Vec::new(), Compression::fast());
    gzip.write_all(geojson.as_bytes()).unwrap();
    let gzip = gzip.finish().unwrap();
    let plain = ways(&network(at, "road.geojson", &geojson));
    assert_eq!(ways(&network(at, "road.geojson.gz", &gzip)), plain);
    for (name, content) in [
        ("cut.geojson.gz", gzip[..gzip.len() / 2].to_vec()),
        ("images.kmz", of(&[image], true)),
        ("two.zip", of(&[("a.kml", kml), ("b.kml", kml)], true)),
    ] {
        std::fs::write(at.join(name), content).unwrap();
        let error = read_network(&at.join(name)).unwrap_err().to_string();
        assert!(error.contains(name), "{error}");
    }
}

/// Returns GPX with the hills as one track: what is before its element, its prefix, name and more points.
fn gpx(declaration: &str, prefix: &str, name: &str, more: &str) -> String {
    let points: String = positions()
        .iter()
        .map(|(longitude, latitude)| {
            format!("<{prefix}trkpt lat=\"{latitude:.7}\" lon=\"{longitude:.7}\"/>{more}")
        })
        .collect();
    format!(
        "{declaration}<{prefix}gpx><{prefix}trk><{prefix}name>{name}</{prefix}name><{prefix}trkseg>\
         {points}</{prefix}trkseg></{prefix}trk></{prefix}gpx>"
    )
}

#[test]
fn names_have_their_entities() {
    let folder = folder();
    let name = "A &amp; B &lt;1&gt; Stra&#223;e &#x41; &amp;amp; &unknown;";
    let expected = "A & B <1> Straße A &amp; &unknown;";
    let text = gpx("", "", name, "");
    assert_is_road(&ways(&network(folder.path(), "road.gpx", text)), expected);
    let line: Vec<String> = positions()
        .iter()
        .map(|(x, y)| format!("{x:.7},{y:.7}"))
        .collect();
    let kml = format!(
        "<kml><Placemark><name>{name}</name><LineString><coordinates>{}</coordinates></LineString>\
         </Placemark></kml>",
        line.join(" ")
    );
    assert_is_road(&ways(&network(folder.path(), "road.kml", kml)), expected);
}

#[test]
fn xml_of_any_encoding_and_prefix_is_read() {
    let folder = folder();
    let at = folder.path();
    let latin = gpx(
        "<?xml version='1.0' encoding='ISO-8859-1'?>",
        "",
        "Straße",
        "",
    );
    let latin: Vec<u8> = latin.chars().map(|c| c as u8).collect();
    let utf16 = gpx(
        "<?xml version=\"1.0\" encoding=\"UTF-16\"?>",
        "",
        "Straße",
        "",
    );
    let utf16: Vec<u8> = "\u{feff}"
        .encode_utf16()
        .chain(utf16.encode_utf16())
        .flat_map(u16::to_le_bytes)
        .collect();
    let marked = gpx("\u{feff}<?xml version=\"1.0\"?>", "", "Straße", "");
    let prefixed = gpx("<?xml version=\"1.0\"?>", "g:", "Straße", "");
    for (name, content) in [
        ("latin.gpx", latin),
        ("utf16.gpx", utf16),
        ("marked.gpx", marked.into_bytes()),
        ("prefixed.gpx", prefixed.into_bytes()),
    ] {
        assert_is_road(&ways(&network(at, name, content)), "Straße");
    }
    // UTF-8 that is none is damage.
    let wrong = gpx("<?xml version=\"1.0\" encoding=\"UTF-8\"?>", "", "road", "");
    let wrong: Vec<u8> = wrong
        .replace("road", "ro\u{df}d")
        .chars()
        .map(|c| c as u8)
        .collect();
    std::fs::write(at.join("wrong.gpx"), wrong).unwrap();
    assert!(read_network(&at.join("wrong.gpx")).is_err());
}

#[test]
fn a_point_that_is_no_place_costs_itself() {
    let folder = folder();
    for point in [
        "<trkpt lat=\"0\" lon=\"0\"/>",
        "<trkpt lat=\"\" lon=\"\"/>",
        "<trkpt lat=\"95\" lon=\"8\"/>",
    ] {
        let text = gpx("", "", "road", point);
        assert_is_road(&ways(&network(folder.path(), "road.gpx", text)), "road");
    }
}

#[test]
fn shapes_without_a_feature_and_collections_of_shapes_are_ways() {
    let folder = folder();
    let feature = way("road", "no", &hills());
    let shape = &feature["geometry"];
    let length = |name: &str, value: &Value| {
        let network = network(folder.path(), name, value.to_string());
        let lengths: Vec<usize> = ways(&network).into_iter().map(|way| way.1).collect();
        lengths
    };
    let whole = length("feature.geojson", &feature);
    assert_eq!(length("shape.geojson", shape), whole);
    let point = json!({"type": "Point", "coordinates": [8.0, 47.0]});
    let collection = json!({"type": "GeometryCollection", "geometries": [point, shape]});
    let mut of_collection = feature.clone();
    of_collection["geometry"] = collection;
    assert_eq!(length("collection.geojson", &of_collection), whole);
}
