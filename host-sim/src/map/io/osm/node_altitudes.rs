//! The altitudes of a map as tags `ele` of the nodes of an OpenStreetMap extract.
//!
//! openrouteservice reads them with `elevation_preprocessed: true`, and keeps those of bridges with
//! `interpolate_bridges_and_tunnels: false`
//! (<https://giscience.github.io/openrouteservice/installation/Configuration>). The file is
//! an osmChange (<https://wiki.openstreetmap.org/wiki/OsmChange>) that `osmium apply-changes` puts
//! into a copy of the extract. OpenStreetMap itself does not want such tags.

use super::pbf;
use super::roads::OsmExtract;
use super::xml::Attribute;
use crate::error::{Error, Result};
use crate::files::output::{Staged, stage as stage_file};
use crate::map::geometry::plane::chord_m;
use crate::map::slopes::profile::WayProfile;
use std::collections::BTreeMap;
use std::io;
use std::path::Path;

/// A node that the change replaces.
struct Changed {
    version: i32,
    place: (f64, f64),
    tags: Vec<(String, String)>,
    altitude_m: f64,
}

/// Writes the nodes of the extract at which the map has an altitude. Returns how many they are.
///
/// # Errors
/// Returns an error of the extract or of the file system, or if no node has an altitude.
pub fn stage(
    path: &Path,
    extract_path: &Path,
    extract: &OsmExtract,
    profiles: &[WayProfile<'_>],
) -> Result<(Staged, usize)> {
    let altitudes = altitudes(extract, profiles);
    if altitudes.is_empty() {
        let problem = "the map has no altitude at any node; expected some";
        return Err(Error::content(extract_path, problem));
    }
    let nodes = changed(extract_path, extract, &altitudes)?;
    let count = nodes.len();
    if count < altitudes.len() {
        let missing = altitudes.len() - count;
        let problem = format!(
            "no elements for {missing} nodes of roads; expected an extract with its nodes \
             (osmium add-locations-to-ways --keep-untagged-nodes)"
        );
        return Err(Error::content(extract_path, problem));
    }
    Ok((stage_file(path, |out| write(out, &nodes))?, count))
}

/// Returns the mean altitude of each node over the ways that pass it.
fn altitudes(extract: &OsmExtract, profiles: &[WayProfile<'_>]) -> BTreeMap<i64, f64> {
    let by_name: BTreeMap<&str, &WayProfile> = profiles
        .iter()
        .filter_map(|profile| Some((profile.way?, profile)))
        .collect();
    let mut sums: BTreeMap<i64, (f64, f64)> = BTreeMap::new();
    for road in &extract.roads {
        let Some(profile) = by_name.get(&*road.name()) else {
            continue;
        };
        let mut at_m = 0.0;
        let mut before = None;
        for node in &road.nodes {
            let Some(&(latitude_deg, longitude_deg)) = extract.positions.get(node) else {
                continue;
            };
            let place = (latitude_deg, longitude_deg, 0.0);
            at_m += before
                .replace(place)
                .map_or(0.0, |before| chord_m(before, place));
            if let Some(altitude_m) = profile.altitude_m(at_m) {
                let sum = sums.entry(*node).or_default();
                *sum = (sum.0 + altitude_m, sum.1 + 1.0);
            }
        }
    }
    sums.into_iter()
        .map(|(node, (sum, count))| (node, sum / count))
        .collect()
}

fn changed(
    path: &Path,
    extract: &OsmExtract,
    altitudes: &BTreeMap<i64, f64>,
) -> Result<BTreeMap<i64, Changed>> {
    let mut nodes = BTreeMap::new();
    pbf::for_each_node(path, |id, version, tags| {
        let Some(&altitude_m) = altitudes.get(&id) else {
            return;
        };
        let changed = Changed {
            version: version.unwrap_or(0).clamp(0, i32::MAX - 1) + 1,
            place: extract.positions[&id],
            tags: owned(tags),
            altitude_m,
        };
        nodes.insert(id, changed);
    })?;
    Ok(nodes)
}

/// Returns the tags but `ele`.
fn owned<'k, 'v>(tags: impl Iterator<Item = (&'k str, &'v str)>) -> Vec<(String, String)> {
    tags.filter(|(key, _)| *key != "ele")
        .map(|(key, value)| (key.to_owned(), value.to_owned()))
        .collect()
}

fn write(out: &mut dyn io::Write, nodes: &BTreeMap<i64, Changed>) -> io::Result<()> {
    writeln!(out, r#"<?xml version="1.0" encoding="UTF-8"?>"#)?;
    writeln!(out, r#"<osmChange version="0.6" generator="roadgrade">"#)?;
    writeln!(out, "<modify>")?;
    for (id, node) in nodes {
        let (latitude_deg, longitude_deg) = node.place;
        writeln!(
            out,
            r#"  <node id="{id}" version="{}" lat="{latitude_deg:.7}" lon="{longitude_deg:.7}">"#,
            node.version
        )?;
        for (key, value) in &node.tags {
            let (key, value) = (Attribute(key), Attribute(value));
            writeln!(out, r#"    <tag k="{key}" v="{value}"/>"#)?;
        }
        writeln!(out, r#"    <tag k="ele" v="{:.2}"/>"#, node.altitude_m)?;
        writeln!(out, "  </node>")?;
    }
    writeln!(out, "</modify>")?;
    writeln!(out, "</osmChange>")
}
