//! `roadgrade export` of slopes: for routers, and as proposals for OpenStreetMap.

use super::told::Told;
use crate::error::{Error, Result};
use crate::map::slopes::edges::edges;
use crate::map::slopes::inclines::inclines;
use crate::map::slopes::profile::{WayProfile, profiles};
use crate::map::{self, Network, TileCount, WayRows};
use crate::source::terrain::Terrain;
use serde_json::json;
use std::path::{Path, PathBuf};

/// Largest sigma of a proposed incline without the option, %: nine in ten of the whole percents are
/// then right, or off by one.
const SIGMA_LIMIT_PERCENT: f64 = 0.25;

/// Options of slopes.
#[derive(Debug, clap::Args)]
pub(super) struct SlopeArgs {
    /// The network of the map, for slopes of its ways: GeoJSON, or an OpenStreetMap extract
    /// (.osm.pbf). GeoJSON and pages of a map do without.
    #[arg(long, value_name = "ROAD")]
    pub(super) road: Option<PathBuf>,
    /// Largest sigma of proposed inclines, % [default: 0.25].
    #[arg(long, value_name = "PERCENT", value_parser = percent)]
    pub(super) sigma_limit: Option<f64>,
    /// Folder of elevation tiles (N47E008.hgt) for the ground beside the roads [default: void].
    #[arg(long, value_name = "DIR")]
    pub(super) terrain: Option<PathBuf>,
}

impl SlopeArgs {
    /// Returns the files of the options, for the check that no output is an input.
    pub(super) fn inputs(&self) -> impl Iterator<Item = &Path> {
        self.road.as_deref().into_iter()
    }

    fn network(&self) -> Result<(&Path, Network)> {
        let problem = "slopes of ways need the network of the map; expected --road ROAD";
        let path = self
            .road
            .as_deref()
            .ok_or_else(|| Error::Usage(problem.to_owned()))?;
        Ok((path, map::read_network(path)?))
    }
}

/// Writes EDGES.csv.
pub(super) fn export_edges(
    args: &SlopeArgs,
    map: &Path,
    out: &Path,
    ways: &[WayRows],
) -> Result<Told> {
    let (_, network) = args.network()?;
    let profiles = of_map(&network, map, ways)?;
    let edges = edges(&profiles);
    map::stage_edges_csv(out, &edges)?.commit()?;
    let known = edges.iter().filter(|edge| edge.slopes.is_some()).count();
    Ok(Told {
        words: format!("{} edges, {known} with slopes", edges.len()),
        json: json!({ "edges": edges.len(), "edges_with_slopes": known }),
    })
}

/// Writes proposals of inclines.
pub(super) fn export_inclines(
    args: &SlopeArgs,
    map: &Path,
    out: &Path,
    ways: &[WayRows],
) -> Result<Told> {
    let (_, network) = args.network()?;
    let limit_percent = args.sigma_limit.unwrap_or(SIGMA_LIMIT_PERCENT);
    let found: Vec<_> = of_map(&network, map, ways)?
        .iter()
        .flat_map(|profile| inclines(profile, limit_percent))
        .collect();
    map::stage_inclines(out, &found)?.commit()?;
    let km = found
        .iter()
        .map(|i| i.range_m.end - i.range_m.start)
        .sum::<f64>()
        / 1000.0;
    let count = found.len();
    Ok(Told {
        words: format!("{count} proposals, {km:.1} km; for a person to review, not for an upload"),
        json: json!({ "proposals": count, "length_km": km }),
    })
}

/// Writes elevation tiles.
pub(super) fn export_tiles(args: &SlopeArgs, out: &Path, ways: &[WayRows]) -> Result<Told> {
    let mut terrain = args.terrain.as_deref().map(Terrain::new);
    let count = map::write_elevation_tiles(out, ways, |latitude_deg, longitude_deg| {
        terrain.as_mut().map_or(Ok(None), |terrain| {
            terrain.altitude_m(latitude_deg, longitude_deg)
        })
    })?;
    let TileCount {
        tiles,
        posts,
        shared,
    } = count;
    Ok(Told {
        words: format!(
            "{tiles} tiles, {posts} posts with a road, {shared} of them shared by roads at different \
             levels"
        ),
        json: json!({ "tiles": tiles, "posts": posts, "shared_posts": shared }),
    })
}

/// Writes the altitudes of nodes.
pub(super) fn export_nodes(
    args: &SlopeArgs,
    map: &Path,
    out: &Path,
    ways: &[WayRows],
) -> Result<Told> {
    let (path, network) = args.network()?;
    let extract = map::read_osm_extract(path)?;
    let profiles = of_map(&network, map, ways)?;
    let (staged, count) = map::stage_node_altitudes(out, path, &extract, &profiles)?;
    staged.commit()?;
    let nodes = extract.positions.len();
    Ok(Told {
        words: format!("ele of {count} nodes of {nodes} on roads"),
        json: json!({ "nodes_with_ele": count, "nodes": nodes }),
    })
}

fn of_map<'n>(network: &'n Network, map: &Path, ways: &[WayRows]) -> Result<Vec<WayProfile<'n>>> {
    profiles(network, ways).map_err(|problem| Error::content(map, problem))
}

fn percent(argument: &str) -> std::result::Result<f64, String> {
    let percent: f64 = argument.parse().map_err(|_| "expected a number of %")?;
    if percent > 0.0 && percent.is_finite() {
        Ok(percent)
    } else {
        Err("expected more than 0 %".to_owned())
    }
}
