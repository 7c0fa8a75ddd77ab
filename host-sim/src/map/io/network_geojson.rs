//! A network as the lines of a GeoJSON file (RFC 7946), or of a sequence of them (RFC 8142).

use super::network_draft::{self, DraftWay, NetworkDraft, Position as Place};
use super::osm::tags;
use super::way_file::check_way;
use crate::error::{Error, Result};
use crate::files::kind::{self, Kind};
use crate::files::marks::BYTE_ORDER_MARK;
use crate::files::unpacked::{self, ROAD_ENDINGS};
use geojson::feature::Id;
use geojson::{Feature, Position, Value as Shape};
use serde::Deserializer;
use serde::de::{self, DeserializeSeed, IgnoredAny, MapAccess, SeqAccess, Visitor};
use serde_json::{Map, Value, json};
use std::borrow::Cow;
use std::cell::Cell;
use std::fmt;
use std::io::{self, BufRead, BufReader, Read};
use std::path::Path;

/// What is expected of a feature.
const EXPECTED: &str = "expected a LineString of two positions or more";
/// Bytes of one feature: a way of 2,500 km with a position every 10 m.
const FEATURE_BYTES: usize = 8 << 20;
/// Properties for the name of a feature, in order of precedence: ours, Overpass, other exports.
const NAMES: [&str; 4] = ["way", "@id", "id", "osm_id"];

/// Extensions of files with lines: GeoJSON, and sequences of it.
const EXTENSIONS: [&str; 7] = [
    "geojson",
    "json",
    "geojsonl",
    "geojsons",
    "geojsonseq",
    "ndjson",
    "jsonl",
];
/// The mark before each object of a sequence. No text of JSON has it.
const RECORD_SEPARATOR: u8 = 0x1e;

/// Returns true if the extension is that of GeoJSON.
#[must_use]
pub fn is_geojson(path: &Path) -> bool {
    let is_of = |extension: &str| EXTENSIONS.iter().any(|e| extension.eq_ignore_ascii_case(e));
    path.extension().and_then(|e| e.to_str()).is_some_and(is_of)
}

/// Returns true if the extension or the content is that of GeoJSON.
pub(super) fn has_geojson(path: &Path) -> bool {
    is_geojson(path) || kind::of(path) == Some(Kind::Json)
}

/// What a collection has, feature by feature: a network may be larger than memory as JSON values.
struct Collection<'a> {
    path: &'a Path,
    /// Renewed for each feature.
    budget: &'a Cell<usize>,
    draft: NetworkDraft,
    /// Number of features.
    count: usize,
    /// The type of an object that is neither a feature nor a collection.
    other: Option<Value>,
    /// The first error; the rest is then skipped.
    trouble: Option<Error>,
}

impl<'a> Collection<'a> {
    fn new(path: &'a Path, budget: &'a Cell<usize>) -> Self {
        Self {
            path,
            budget,
            draft: NetworkDraft::default(),
            count: 0,
            other: None,
            trouble: None,
        }
    }

    fn take(&mut self, feature: Value) {
        self.count += 1;
        self.budget.set(FEATURE_BYTES);
        if self.trouble.is_some() {
            return;
        }
        let place = format!("feature {}", self.count);
        match way_of(feature, &place) {
            Ok(way) => {
                let place = format!("{place}: way {}", way.name);
                if let Err(problem) = self.draft.add(&place, way) {
                    self.trouble = Some(Error::content(self.path, format!("{place}: {problem}")));
                }
            }
            Err(problem) => self.draft.leave_out(format!("{place}: {problem}")),
        }
    }
}

/// Returns the way that a feature is. One without a name has its place as its name.
fn way_of(feature: Value, place: &str) -> std::result::Result<DraftWay, String> {
    let feature = Feature::from_json_value(feature).map_err(|e| e.to_string())?;
    let name = name_of(&feature)?.unwrap_or_else(|| place.to_owned());
    let wrong = |problem: String| format!("way {name}: {problem}");
    let tag = |key: &str| text_of(&feature, key);
    Ok(DraftWay {
        parts: parts_of(&feature).map_err(wrong)?,
        directions: tags::directions(tag).map_err(wrong)?,
        structure: tags::structure(tag),
        name: name.clone(),
    })
}

impl<'de> Visitor<'de> for &mut Collection<'_> {
    type Value = ();

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str("a GeoJSON FeatureCollection")
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> std::result::Result<(), A::Error> {
        let mut has_features = false;
        let mut object = Map::new();
        while let Some(key) = map.next_key::<String>()? {
            match key.as_str() {
                "features" => {
                    has_features = true;
                    map.next_value_seed(Features(self))?;
                }
                "type" | "id" | "geometry" | "properties" | "coordinates" | "geometries" => {
                    object.insert(key, map.next_value()?);
                }
                _ => {
                    map.next_value::<IgnoredAny>()?;
                }
            }
        }
        match object.get("type") {
            Some(Value::String(kind)) if kind == "FeatureCollection" && !has_features => {
                return Err(de::Error::missing_field("features"));
            }
            Some(Value::String(kind)) if kind == "FeatureCollection" => {}
            Some(Value::String(kind)) if kind == "Feature" => self.take(Value::Object(object)),
            // A shape alone.
            Some(Value::String(_))
                if object.contains_key("coordinates") || object.contains_key("geometries") =>
            {
                let geometry = Value::Object(object);
                self.take(json!({"type": "Feature", "properties": null, "geometry": geometry}));
            }
            Some(kind) => self.other = Some(kind.clone()),
            None => return Err(de::Error::missing_field("type")),
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
        for byte in &mut buffer[..count] {
            if *byte == RECORD_SEPARATOR {
                *byte = b' ';
            }
        }
        Ok(count)
    }
}

/// Reads the ways of a network.
///
/// # Errors
/// Returns an error that names the file, the line or feature, and the expected value.
pub(super) fn read_geojson(path: &Path) -> Result<NetworkDraft> {
    let file = unpacked::open(path, ROAD_ENDINGS)?;
    let budget = Cell::new(FEATURE_BYTES);
    let mut file = BufReader::new(Counted {
        inner: file,
        left: &budget,
    });
    if file
        .fill_buf()
        .map_err(Error::io(path))?
        .starts_with(BYTE_ORDER_MARK)
    {
        file.consume(BYTE_ORDER_MARK.len());
    }
    let mut collection = Collection::new(path, &budget);
    let mut json = serde_json::Deserializer::from_reader(file);
    loop {
        let read = json.deserialize_any(&mut collection);
        read.map_err(|error| wrong_json(path, error))?;
        // A sequence has more objects.
        if json.end().is_ok() {
            break;
        }
    }
    let Collection {
        draft,
        count,
        other,
        trouble,
        ..
    } = collection;
    if let Some(kind) = other {
        let problem = format!("type {kind}; expected FeatureCollection or Feature");
        return Err(Error::content(path, problem));
    }
    if count == 0 {
        return Err(Error::content(path, "no features; expected LineStrings"));
    }
    trouble.map_or(Ok(draft), Err)
}

fn wrong_json(path: &Path, error: serde_json::Error) -> Error {
    if error.is_io() {
        return Error::io(path)(error.into());
    }
    let expected = "a GeoJSON FeatureCollection";
    match error.line() {
        0 => Error::content(path, format!("{error}; expected {expected}")),
        line => Error::line(path, line as u64, error.to_string(), expected),
    }
}

/// Returns a property that is not null.
fn property<'f>(feature: &'f Feature, key: &str) -> Option<&'f Value> {
    feature.property(key).filter(|value| !value.is_null())
}

/// Returns the name of a feature, if it has one.
fn name_of(feature: &Feature) -> std::result::Result<Option<String>, String> {
    let property = NAMES.iter().find_map(|key| property(feature, key));
    let name = match (property, &feature.id) {
        (Some(Value::String(name)), _) | (None, Some(Id::String(name))) => name.clone(),
        (Some(Value::Number(number)), _) | (None, Some(Id::Number(number))) => number.to_string(),
        (Some(other), _) => return Err(format!("way is {other}; expected a text or a number")),
        (None, None) => return Ok(None),
    };
    check_way(&name).map_err(|flaw| flaw.to_string())?;
    Ok(Some(name))
}

/// Returns the text of a property; exports write some values as booleans or numbers.
fn text_of<'f>(feature: &'f Feature, key: &str) -> Option<Cow<'f, str>> {
    Some(match property(feature, key)? {
        Value::String(text) => Cow::from(text),
        other => Cow::from(other.to_string()),
    })
}

/// Returns the lines of a feature.
fn parts_of(feature: &Feature) -> std::result::Result<Vec<Vec<Place>>, String> {
    match feature.geometry.as_ref().map(|geometry| &geometry.value) {
        Some(shape) => lines_of(shape),
        None => Err(format!("no geometry; {EXPECTED}")),
    }
}

/// Returns the lines of a shape. Other shapes of a collection are left out with it.
fn lines_of(shape: &Shape) -> std::result::Result<Vec<Vec<Place>>, String> {
    let is_line = |of: &Shape| matches!(of, Shape::LineString(_) | Shape::MultiLineString(_));
    match shape {
        Shape::LineString(line) => Ok(vec![points_of(line)?]),
        Shape::MultiLineString(lines) => lines.iter().map(|line| points_of(line)).collect(),
        Shape::GeometryCollection(shapes) if shapes.iter().any(|of| is_line(&of.value)) => {
            let lines = shapes.iter().filter(|of| is_line(&of.value));
            let lines = lines.map(|of| lines_of(&of.value));
            Ok(lines.collect::<std::result::Result<Vec<_>, _>>()?.concat())
        }
        other => Err(format!("a {}; {EXPECTED}", other.type_name())),
    }
}

fn points_of(positions: &[Position]) -> std::result::Result<Vec<Place>, String> {
    let point = |(number, position)| point(position).map_err(|e| format!("position {number}: {e}"));
    (1..).zip(positions).map(point).collect()
}

fn point(position: &Position) -> std::result::Result<Place, String> {
    let [longitude_deg, latitude_deg, ..] = *position.as_slice() else {
        return Err("expected longitude and latitude".to_owned());
    };
    network_draft::position(latitude_deg, longitude_deg)
}
