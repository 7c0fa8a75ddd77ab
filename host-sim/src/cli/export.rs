//! `roadgrade export`.

use super::export_slopes::{SlopeArgs, export_edges, export_inclines, export_nodes, export_tiles};
use super::outputs;
use super::told::Told;
use crate::error::{Error, Result};
use crate::files::flash_image::is_memory;
use crate::files::output::is_written_through;
use crate::files::run;
use crate::map;
use crate::report::map_page;
use serde_json::json;
use std::path::PathBuf;

/// Arguments of `export`.
#[derive(Debug, clap::Args)]
#[command(
    after_help = "Example:\n  roadgrade export map.csv --out map.geojson",
    after_long_help = "GeoJSON (RFC 7946, WGS 84): one line for each segment of a way without a gap. It has the length, \
    the mean grade and the mean sigma, and arrays with one value per position: distances_m, \
    grades_percent, grade_sigmas_percent, altitudes_m, runs. With --pieces the lines are short and \
    have scalar properties only; QGIS and geopandas can colour them by grade_percent. The sigma of \
    a piece is the mean sigma of its cells, because errors of neighbouring cells are correlated.\n\n\
    KML: the same lines, with grade and sigma as text. GPX: a track for each way, with altitudes; GPX \
    has no grades.\n\n\
    NAME.csv or NAME.parquet: the whole map, as `fuse` writes it.\n\n\
    Folder: WAY.csv for each way (WAY.backward.csv for the direction against its \
    points). Each file is a map of its own. Characters that a file name cannot have become _.\n\n\
    Road memory: NAME.csv or NAME.parquet is a run that `fuse` reads, with one road after the other. It has \
    no times and speeds.\n\n\
    Page: one HTML file. It shows the map in plan view, coloured by grade and by sigma, and along \
    each way the grade with two sigmas, the sigma and the number of runs.\n\n\
    Slopes need --road, the network of the map. Edges: a CSV file with the mean grade, the steepest 25 m up and \
    down and the sigma of each edge between junctions, in each direction. Inclines: proposals of the tag \
    incline of OpenStreetMap for a person to review, as GeoJSON, or as .osm for JOSM, which then refuses \
    to upload it: sections of 100 m and more of a similar grade of 2 % and more, where no 25 m has more \
    than --sigma-limit. Nothing is uploaded.\n\n\
    Routers: a folder of elevation tiles (--format hgt) for Valhalla and GraphHopper, in whole metres; \
    --terrain fills the ground beside the roads. For openrouteservice an osmChange (.osc) with ele of the \
    nodes of an .osm.pbf, for `osmium apply-changes`.\n\n\
    Examples:\n  \
    roadgrade export map.parquet --out map.geojson --pieces 50\n  \
    roadgrade export map.parquet --out map.kml --pieces 100\n  \
    roadgrade export map.parquet --out map.html\n  \
    roadgrade export map.grade --out map.csv\n  \
    roadgrade export map.csv --out ways\n  \
    roadgrade export map.csv --road city.osm.pbf --format edges --out edges.csv\n  \
    roadgrade export map.csv --road city.osm.pbf --format inclines --out inclines.geojson\n  \
    roadgrade export map.csv --format hgt --terrain srtm --out elevation\n  \
    roadgrade export map.csv --road city.osm.pbf --out ele.osc\n  \
    roadgrade export roads.memory --out run.csv"
)]
pub struct Args {
    /// A map that `fuse`, `map` or `pack` wrote, or the road memory of `estimate --memory`.
    #[arg(value_name = "MAP")]
    map: PathBuf,
    /// Output: NAME.csv, NAME.parquet, NAME.geojson, NAME.kml, NAME.gpx, NAME.html, NAME.osm, NAME.osc,
    /// or a folder for one CSV file per way.
    #[arg(long, value_name = "FILE|DIR")]
    out: PathBuf,
    /// Output format [default: by the extension of --out].
    #[arg(long, value_enum)]
    format: Option<Format>,
    /// Length of the lines of GeoJSON or KML, m, at least 2.5 (one line per cell).
    #[arg(long, value_name = "METRES", value_parser = metres)]
    pieces: Option<f64>,
    #[command(flatten)]
    slopes: SlopeArgs,
    /// Print what was written as JSON.
    #[arg(long, hide_short_help = true)]
    json: bool,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
enum Format {
    Geojson,
    Kml,
    Gpx,
    /// A folder with one CSV file for each way.
    Csv,
    /// The whole map: Parquet if the name ends in .parquet, else CSV.
    Map,
    Page,
    /// Slopes of the edges between junctions, as CSV.
    Edges,
    /// Proposals of OpenStreetMap inclines: GeoJSON, or for JOSM if the name ends in .osm.
    Inclines,
    /// A folder of elevation tiles, DIR/N47/N47E008.hgt, for Valhalla and GraphHopper.
    Hgt,
    /// An osmChange with ele of nodes, for openrouteservice.
    Ele,
}

/// Runs the command.
pub fn run(args: &Args) -> Result<()> {
    let format = args.format()?;
    let has_pieces = [Format::Geojson, Format::Kml].contains(&format);
    if args.pieces.is_some() && !has_pieces {
        let problem = "--pieces applies to GeoJSON and KML only; expected --out NAME.geojson or \
                       NAME.kml";
        return Err(Error::Usage(problem.to_owned()));
    }
    args.check_slopes(format)?;
    let inputs = std::iter::once(&*args.map).chain(args.slopes.inputs());
    outputs::check(inputs, [&*args.out])?;
    if format == Format::Hgt && is_written_through(&args.out) {
        let problem = "elevation tiles are several files; expected a folder as --out";
        return Err(Error::Usage(problem.to_owned()));
    }
    if ![Format::Csv, Format::Hgt].contains(&format) {
        outputs::check_folder(&args.out)?;
    }
    let told = if is_memory(&args.map) {
        export_memory(args, format)?
    } else {
        export_map(args, format)?
    };
    told.tell(&args.out, args.json)
}

fn export_map(args: &Args, format: Format) -> Result<Told> {
    let ways = map::read_map_ways(&args.map)?;
    match format {
        Format::Geojson => map::stage_map_geojson(&args.out, &ways, args.pieces)?.commit()?,
        Format::Kml => map::stage_map_kml(&args.out, &ways, args.pieces)?.commit()?,
        Format::Gpx => map::stage_map_gpx(&args.out, &ways)?.commit()?,
        Format::Map => map::stage_map_ways(&args.out, &ways)?.commit()?,
        Format::Csv => map::write_ways_csv(&args.out, &args.map, &ways)?,
        Format::Page => map_page::page(&args.map, &ways, |_| Vec::new())
            .stage_alone(&args.out)?
            .commit()?,
        Format::Edges => return export_edges(&args.slopes, &args.map, &args.out, &ways),
        Format::Inclines => return export_inclines(&args.slopes, &args.map, &args.out, &ways),
        Format::Hgt => return export_tiles(&args.slopes, &args.out, &ways),
        Format::Ele => return export_nodes(&args.slopes, &args.map, &args.out, &ways),
    }
    let cells: usize = ways.iter().map(|way| way.rows.len()).sum();
    let count = ways.len();
    Ok(Told {
        words: format!("{cells} cells, ways: {count}"),
        json: json!({ "cells": cells, "ways": count }),
    })
}

/// Writes the roads of a road memory as a run.
fn export_memory(args: &Args, format: Format) -> Result<Told> {
    if format != Format::Map {
        let problem = "a road memory becomes a run; expected --out NAME.csv or NAME.parquet";
        return Err(Error::Usage(problem.to_owned()));
    }
    let learned = map::read_learned_run(&args.map)?;
    run::write(&args.out, &learned.rows)?;
    let (cells, roads) = (learned.rows.len(), learned.roads);
    Ok(Told {
        words: format!("{cells} cells, roads: {roads}"),
        json: json!({ "cells": cells, "roads": roads }),
    })
}

impl Args {
    /// Refuses options that the format does not use.
    fn check_slopes(&self, format: Format) -> Result<()> {
        let SlopeArgs {
            road,
            sigma_limit,
            terrain,
        } = &self.slopes;
        let by_way = [Format::Edges, Format::Inclines, Format::Ele];
        let unused = [
            (
                road.is_some() && !by_way.contains(&format),
                "--road applies to --format edges, inclines and ele",
            ),
            (
                sigma_limit.is_some() && format != Format::Inclines,
                "--sigma-limit applies to --format inclines",
            ),
            (
                terrain.is_some() && format != Format::Hgt,
                "--terrain applies to --format hgt",
            ),
        ];
        match unused.into_iter().find(|(is_unused, _)| *is_unused) {
            Some((_, problem)) => Err(Error::Usage(format!(
                "{problem} only; expected one of them"
            ))),
            None => Ok(()),
        }
    }

    fn format(&self) -> Result<Format> {
        if let Some(format) = self.format {
            return Ok(format);
        }
        let extension = self.out.extension().unwrap_or_default().to_string_lossy();
        match extension.to_ascii_lowercase().as_str() {
            "geojson" | "json" => Ok(Format::Geojson),
            "kml" => Ok(Format::Kml),
            "gpx" => Ok(Format::Gpx),
            "html" | "htm" => Ok(Format::Page),
            "osm" => Ok(Format::Inclines),
            "osc" => Ok(Format::Ele),
            _ if self.out.is_dir() => Ok(Format::Csv),
            "csv" | "parquet" => Ok(Format::Map),
            "" if is_written_through(&self.out) => Err(Error::Usage(
                "--out has no ending; expected --format map, geojson, kml, gpx, page, edges, inclines or ele".to_owned(),
            )),
            "" => Ok(Format::Csv),
            other => Err(Error::Usage(format!(
                "--out ends in .{other}; expected .csv, .parquet, .geojson, .kml, .gpx, .html, .osm, .osc, a folder, or --format"
            ))),
        }
    }
}

fn metres(argument: &str) -> std::result::Result<f64, String> {
    let metres: f64 = argument
        .parse()
        .map_err(|_| "expected a number of metres")?;
    if metres >= map::GRID_M && metres.is_finite() {
        Ok(metres)
    } else {
        Err(format!(
            "expected at least {} m, the length of a cell",
            map::GRID_M
        ))
    }
}
