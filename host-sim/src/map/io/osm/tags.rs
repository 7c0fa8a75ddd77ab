//! Tags of roads, as the wiki of OpenStreetMap defines them. `tag` returns the value of a key.

use crate::map::geometry::structure::Structure;
use crate::map::geometry::way_name::WayDirection;
use std::borrow::Cow;

/// Values of `highway` that vehicles with a log may drive on
/// (<https://wiki.openstreetmap.org/wiki/Key:highway>). Those of links end in `_link`.
const ROADS: [&str; 11] = [
    "motorway",
    "trunk",
    "primary",
    "secondary",
    "tertiary",
    "unclassified",
    "residential",
    "living_street",
    "service",
    "road",
    "busway",
];

/// Returns true for a road that vehicles with a log may drive on.
pub(super) fn is_road<'t>(tag: &impl Fn(&str) -> Option<&'t str>) -> bool {
    let highway = tag("highway").unwrap_or_default();
    let class = highway.strip_suffix("_link").unwrap_or(highway);
    ROADS.contains(&class) && tag("area") != Some("yes")
}

/// Returns the directions of a way: both unless `oneway` says otherwise; roundabouts and motorways
/// are one-way by default.
///
/// # Errors
/// Returns an error for a value of `oneway` that the wiki does not have.
pub fn directions<'t>(
    tag: impl Fn(&str) -> Option<Cow<'t, str>>,
) -> Result<Vec<WayDirection>, String> {
    use WayDirection::{Backward, Forward};
    let is = |key: &str, values: &[&str]| tag(key).is_some_and(|value| values.contains(&&*value));
    let implied = || is("junction", &["roundabout", "circular"]) || is("highway", &["motorway"]);
    match tag("oneway").as_deref() {
        None | Some("") if implied() => Ok(vec![Forward]),
        None | Some("" | "no" | "false" | "0" | "reversible" | "alternating") => {
            Ok(vec![Forward, Backward])
        }
        Some("yes" | "true" | "1") => Ok(vec![Forward]),
        Some("-1" | "reverse") => Ok(vec![Backward]),
        Some(other) => Err(format!("oneway is {other:?}; expected yes, no or -1")),
    }
}

/// Returns the structure of a way: any value of its key but `no`.
pub fn structure<'t>(tag: impl Fn(&str) -> Option<Cow<'t, str>>) -> Option<Structure> {
    Structure::ALL.into_iter().find(|structure| {
        let value = tag(structure.word());
        value.is_some_and(|value| !["", "no", "false"].contains(&&*value))
    })
}
