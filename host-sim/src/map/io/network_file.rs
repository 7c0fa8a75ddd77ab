//! The road or network of a map from a file: ROAD.csv or ROAD.parquet with one road or several
//! ways, or the lines of a GeoJSON file.

use super::road_file::read_ways;
use super::road_row::RoadRow;
use super::way_file::check_way;
use crate::error::{Error, Result};
use crate::files::kind::{self, Kind};
use crate::files::row_check;
use crate::map::geometry::network::Network;
use crate::map::geometry::network_size::NetworkSize;
use crate::map::geometry::plane::chord_m;
use crate::map::geometry::road_line::{RoadLine, RoadPoint};
use crate::map::geometry::way_name::{WayDirection, WayName};
use geojson::feature::Id;
use geojson::{Feature, Position, Value as Shape};
use serde::Deserializer;
use serde::de::{self, DeserializeSeed, IgnoredAny, MapAccess, SeqAccess, Visitor};
use serde_json::Value;
use std::cell::Cell;
use std::collections::BTreeMap;
use std::fmt;
use std::fs::File;
use std::io::{self, BufReader, Read};
use std::path::Path;

/// Bytes of one feature: a way of 2,500 km with a position every 10 m.
const FEATURE_BYTES: usize = 8 << 20;
/// Properties for the name of a feature, in order of precedence: ours, Overpass, other exports.
const NAMES: [&str; 4] = ["way", "@id", "id", "osm_id"];

/// Returns true if the extension is that of GeoJSON.
#[must_use]
pub fn is_geojson(path: &Path) -> bool {
    path.extension().is_some_and(|extension| {
        extension.eq_ignore_ascii_case("geojson") || extension.eq_ignore_ascii_case("json")
    })
}

/// Reads a road or a network.
///
/// # Errors
/// Returns an error that names the file, the line or feature, and the expected value.
pub fn read(path: &Path) -> Result<Network> {
    if is_geojson(path) {
        return read_geojson(path).map_err(|e| kind::explained(e, path, &[Kind::Json]));
    }
    let mut ways = Vec::new();
    let mut size = NetworkSize::default();
    for way in read_ways(path)? {
        let points = way.rows.iter().map(RoadRow::point).collect();
        let Some(name) = way.name else {
            return road_through(path, points);
        };
        let line = RoadLine::new(points)
            .map_err(|problem| Error::content(path, format!("way {name}: {problem}")))?;
        size.add(&line)
            .map_err(|problem| Error::content(path, problem.to_string()))?;
        ways.push((name, line));
    }
    network(path, ways)
}

/// Creates a network, if its ways meet as roads do.
fn network(path: &Path, ways: Vec<(WayName, RoadLine)>) -> Result<Network> {
    NetworkSize::check_meetings(ways.iter().map(|(_, line)| line))
        .map_err(|problem| Error::content(path, problem.to_string()))?;
    Ok(Network::new(ways))
}

/// Creates a single road through these points, with a point for each of its cells. It is then
/// the same whether it comes from its file or from a store. `path` is for error messages.
///
/// # Errors
/// Returns an error if the points do not make a road.
pub fn road_through(path: &Path, points: Vec<RoadPoint>) -> Result<Network> {
    RoadLine::new(points)
        .and_then(|line| RoadLine::new(line.on_grid()))
        .map_err(|problem| problem.to_string())
        .and_then(|line| {
            let size = NetworkSize::default().add(&line);
            size.map(|()| line).map_err(|problem| problem.to_string())
        })
        .map(Network::from)
        .map_err(|problem| Error::content(path, problem))
}

/// What a collection has, feature by feature: a network may be larger than memory as JSON values.
struct Collection<'a> {
    path: &'a Path,
    /// Renewed for each feature.
    budget: &'a Cell<usize>,
    size: NetworkSize,
    ways: Vec<(WayName, RoadLine)>,
    /// The number of the feature of each name.
    numbers: BTreeMap<String, usize>,
    /// Number of features.
    count: usize,
    kind: Option<Value>,
    /// The first error; the rest is then skipped.
    trouble: Option<Error>,
}

impl<'a> Collection<'a> {
    const fn new(path: &'a Path, budget: &'a Cell<usize>) -> Self {
        Self {
            path,
            budget,
            size: NetworkSize::new(),
            ways: Vec::new(),
            numbers: BTreeMap::new(),
            count: 0,
            kind: None,
            trouble: None,
        }
    }

    fn take(&mut self, feature: Value) {
        self.count += 1;
        self.budget.set(FEATURE_BYTES);
        if self.trouble.is_none()
            && let Err(problem) = self.add(feature)
        {
            let problem = format!("feature {}: {problem}", self.count);
            self.trouble = Some(Error::content(self.path, problem));
        }
    }

    fn add(&mut self, feature: Value) -> std::result::Result<(), String> {
        let feature = Feature::from_json_value(feature).map_err(|e| e.to_string())?;
        let name = name_of(&feature)?;
        let wrong = |problem: String| format!("way {name}: {problem}");
        if let Some(first) = self.numbers.insert(name.clone(), self.count) {
            let problem = format!("same name as feature {first}; expected unique names");
            return Err(wrong(problem));
        }
        let points = points_of(&feature).map_err(wrong)?;
        for direction in directions(&feature).map_err(wrong)? {
            let line = line(points.clone(), direction).map_err(wrong)?;
            self.size.add(&line).map_err(|e| wrong(e.to_string()))?;
            let way = name.clone();
            self.ways.push((WayName { way, direction }, line));
        }
        Ok(())
    }
}

impl<'de> Visitor<'de> for &mut Collection<'_> {
    type Value = ();

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str("a GeoJSON FeatureCollection")
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> std::result::Result<(), A::Error> {
        let mut has_features = false;
        while let Some(key) = map.next_key::<String>()? {
            match key.as_str() {
                "type" => self.kind = Some(map.next_value()?),
                "features" => {
                    has_features = true;
                    map.next_value_seed(Features(self))?;
                }
                _ => {
                    map.next_value::<IgnoredAny>()?;
                }
            }
        }
        if self.kind.is_none() {
            return Err(de::Error::missing_field("type"));
        }
        if !has_features {
            return Err(de::Error::missing_field("features"));
        }
        Ok(())
    }
}

/// The list of features.
struct Features<'c, 'a>(&'c mut Collection<'a>);

impl<'de> DeserializeSeed<'de> for Features<'_, '_> {
    type Value = ();

    fn deserialize<D: Deserializer<'de>>(self, list: D) -> std::result::Result<(), D::Error> {
        list.deserialize_seq(self)
    }
}

impl<'de> Visitor<'de> for Features<'_, '_> {
    type Value = ();

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str("a list of features")
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut list: A) -> std::result::Result<(), A::Error> {
        while let Some(feature) = list.next_element::<Value>()? {
            self.0.take(feature);
        }
        Ok(())
    }
}

/// A reader with a budget that others renew.
struct Counted<'b, R> {
    inner: R,
    left: &'b Cell<usize>,
}

impl<R: Read> Read for Counted<'_, R> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let most = buffer.len().min(self.left.get());
        if most == 0 && !buffer.is_empty() {
            let problem =
                format!("a feature of more than {FEATURE_BYTES} bytes; expected smaller ones");
            return Err(io::Error::other(problem));
        }
        let count = self.inner.read(&mut buffer[..most])?;
        self.left.set(self.left.get() - count);
        Ok(count)
    }
}

fn read_geojson(path: &Path) -> Result<Network> {
    let file = File::open(path).map_err(Error::io(path))?;
    let budget = Cell::new(FEATURE_BYTES);
    let file = BufReader::new(Counted {
        inner: file,
        left: &budget,
    });
    let mut collection = Collection::new(path, &budget);
    let mut json = serde_json::Deserializer::from_reader(file);
    let read = json
        .deserialize_any(&mut collection)
        .and_then(|()| json.end());
    let Collection {
        ways,
        count,
        kind,
        trouble,
        ..
    } = collection;
    read.map_err(|e| {
        if e.is_io() {
            return Error::io(path)(e.into());
        }
        let expected = "a GeoJSON FeatureCollection";
        match e.line() {
            0 => Error::content(path, format!("{e}; expected {expected}")),
            line => Error::line(path, line as u64, e.to_string(), expected),
        }
    })?;
    let kind = kind.unwrap_or_default();
    if kind.as_str() != Some("FeatureCollection") {
        let problem = format!("type {kind}; expected FeatureCollection");
        return Err(Error::content(path, problem));
    }
    if count == 0 {
        return Err(Error::content(path, "no features; expected LineStrings"));
    }
    trouble.map_or_else(|| network(path, ways), Err)
}

/// Returns a property that is not null.
fn property<'f>(feature: &'f Feature, key: &str) -> Option<&'f Value> {
    feature.property(key).filter(|value| !value.is_null())
}

fn name_of(feature: &Feature) -> std::result::Result<String, String> {
    let property = NAMES.iter().find_map(|key| property(feature, key));
    let name = match (property, &feature.id) {
        (Some(Value::String(name)), _) | (None, Some(Id::String(name))) => name.clone(),
        (Some(Value::Number(number)), _) | (None, Some(Id::Number(number))) => number.to_string(),
        (Some(other), _) => return Err(format!("way is {other}; expected a text or a number")),
        (None, None) => return Err("no name; expected a property \"way\", or an id".to_owned()),
    };
    check_way(&name).map_err(|flaw| format!("{}; expected {}", flaw.problem, flaw.expected))?;
    Ok(name)
}

/// Returns the directions of a way, as OpenStreetMap defines them: both unless `oneway` says
/// otherwise; roundabouts and motorways are one-way by default.
fn directions(feature: &Feature) -> std::result::Result<Vec<WayDirection>, String> {
    use WayDirection::{Backward, Forward};
    let implied = || {
        let is = |key: &str, values: &[&str]| {
            property(feature, key)
                .and_then(Value::as_str)
                .is_some_and(|value| values.contains(&value))
        };
        is("junction", &["roundabout", "circular"]) || is("highway", &["motorway"])
    };
    let text = property(feature, "oneway").map(|value| match value {
        Value::String(text) => text.clone(),
        other => other.to_string(),
    });
    match text.as_deref() {
        None | Some("") if implied() => Ok(vec![Forward]),
        None | Some("" | "no" | "false" | "0" | "reversible" | "alternating") => {
            Ok(vec![Forward, Backward])
        }
        Some("yes" | "true" | "1") => Ok(vec![Forward]),
        Some("-1" | "reverse") => Ok(vec![Backward]),
        Some(other) => Err(format!("oneway is {other:?}; expected yes, no or -1")),
    }
}

/// Returns the positions: latitude and longitude, deg.
fn points_of(feature: &Feature) -> std::result::Result<Vec<(f64, f64)>, String> {
    let expected = "expected a LineString of two positions or more";
    let positions = match feature.geometry.as_ref().map(|geometry| &geometry.value) {
        Some(Shape::LineString(coordinates)) => coordinates,
        // Lines read from a shapefile are always of this type.
        Some(Shape::MultiLineString(coordinates)) => match &coordinates[..] {
            [line] => line,
            parts => {
                let count = parts.len();
                return Err(format!("a MultiLineString of {count} parts; {expected}"));
            }
        },
        Some(other) => return Err(format!("a {}; {expected}", other.type_name())),
        None => return Err(format!("no geometry; {expected}")),
    };
    let mut points: Vec<(f64, f64)> = Vec::with_capacity(positions.len());
    for (number, position) in (1..).zip(positions) {
        let point = point(position).map_err(|e| format!("position {number}: {e}"))?;
        // A repeated position is no step.
        if points.last() != Some(&point) {
            points.push(point);
        }
    }
    if points.len() < 2 {
        return Err(format!(
            "{} position(s) that differ; {expected}",
            points.len()
        ));
    }
    Ok(points)
}

fn point(position: &Position) -> std::result::Result<(f64, f64), String> {
    let [longitude_deg, latitude_deg, ..] = *position.as_slice() else {
        return Err("expected longitude and latitude".to_owned());
    };
    row_check::position(latitude_deg, longitude_deg)
        .map_err(|flaw| format!("{}; expected {}", flaw.problem, flaw.expected))?;
    Ok((latitude_deg, longitude_deg))
}

/// Creates the line; distances are those on the ellipsoid.
fn line(
    mut points: Vec<(f64, f64)>,
    direction: WayDirection,
) -> std::result::Result<RoadLine, String> {
    if direction == WayDirection::Backward {
        points.reverse();
    }
    let mut distance_m = 0.0;
    let mut before = None;
    let points = points.into_iter().map(|(latitude_deg, longitude_deg)| {
        let place = (latitude_deg, longitude_deg, 0.0);
        distance_m += before
            .replace(place)
            .map_or(0.0, |before| chord_m(before, place));
        RoadPoint {
            distance_m,
            latitude_deg,
            longitude_deg,
        }
    });
    RoadLine::new(points.collect()).map_err(|problem| problem.to_string())
}
