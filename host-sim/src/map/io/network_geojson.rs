//! A network as the lines of a GeoJSON file (RFC 7946).

use super::network_draft::{DraftWay, NetworkDraft};
use super::osm::tags;
use super::way_file::check_way;
use crate::error::{Error, Result};
use crate::files::row_check;
use crate::map::geometry::network::Network;
use geojson::feature::Id;
use geojson::{Feature, Position, Value as Shape};
use serde::Deserializer;
use serde::de::{self, DeserializeSeed, IgnoredAny, MapAccess, SeqAccess, Visitor};
use serde_json::Value;
use std::borrow::Cow;
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

/// What a collection has, feature by feature: a network may be larger than memory as JSON values.
struct Collection<'a> {
    path: &'a Path,
    /// Renewed for each feature.
    budget: &'a Cell<usize>,
    draft: NetworkDraft,
    /// The number of the feature of each name.
    numbers: BTreeMap<String, usize>,
    /// Number of features.
    count: usize,
    kind: Option<Value>,
    /// The first error; the rest is then skipped.
    trouble: Option<Error>,
}

impl<'a> Collection<'a> {
    fn new(path: &'a Path, budget: &'a Cell<usize>) -> Self {
        Self {
            path,
            budget,
            draft: NetworkDraft::default(),
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
        let tag = |key: &str| text_of(&feature, key);
        let way = DraftWay {
            points: points_of(&feature).map_err(wrong)?,
            directions: tags::directions(tag).map_err(wrong)?,
            structure: tags::structure(tag),
            name: name.clone(),
        };
        self.draft.add(way).map_err(wrong)
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

/// Reads a network.
///
/// # Errors
/// Returns an error that names the file, the line or feature, and the expected value.
pub(super) fn read_geojson(path: &Path) -> Result<Network> {
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
        draft,
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
    if let Some(trouble) = trouble {
        return Err(trouble);
    }
    draft
        .finish()
        .map_err(|problem| Error::content(path, problem))
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

/// Returns the text of a property; exports write some values as booleans or numbers.
fn text_of<'f>(feature: &'f Feature, key: &str) -> Option<Cow<'f, str>> {
    Some(match property(feature, key)? {
        Value::String(text) => Cow::from(text),
        other => Cow::from(other.to_string()),
    })
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
