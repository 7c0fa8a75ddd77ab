//! `roadgrade export`.

use super::outputs;
use crate::error::{Error, Result, on_one_line};
use crate::files::flash_image::is_memory;
use crate::files::output::is_written_through;
use crate::files::run;
use crate::map;
use crate::report::map_page;
use crate::terminal::print::note;
use std::path::PathBuf;

/// Arguments of `export`.
#[derive(Debug, clap::Args)]
#[command(
    after_help = "GeoJSON (RFC 7946, WGS 84): one line for each segment of a way without a gap. It has the length, \
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
    Examples:\n  \
    roadgrade export map.parquet --out map.geojson --pieces 50\n  \
    roadgrade export map.parquet --out map.kml --pieces 100\n  \
    roadgrade export map.parquet --out map.html\n  \
    roadgrade export map.grade --out map.csv\n  \
    roadgrade export map.csv --out ways\n  \
    roadgrade export roads.memory --out run.csv"
)]
pub struct Args {
    /// A map that `fuse`, `map` or `pack` wrote, or the road memory of `estimate --memory`.
    #[arg(value_name = "MAP")]
    map: PathBuf,
    /// Output: NAME.csv, NAME.parquet, NAME.geojson, NAME.kml, NAME.gpx, NAME.html, or a folder for
    /// one CSV file per way.
    #[arg(long, value_name = "FILE|DIR")]
    out: PathBuf,
    /// Output format [default: by the extension of --out].
    #[arg(long, value_enum)]
    format: Option<Format>,
    /// Length of the lines of GeoJSON or KML, m, at least 2.5 (one line per cell).
    #[arg(long, value_name = "METRES", value_parser = metres)]
    pieces: Option<f64>,
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
    outputs::check([&*args.map], [&*args.out])?;
    if format != Format::Csv {
        outputs::check_folder(&args.out)?;
    }
    if is_memory(&args.map) {
        return export_memory(args, format);
    }
    let ways = map::read_map_ways(&args.map)?;
    match format {
        Format::Geojson => map::stage_map_geojson(&args.out, &ways, args.pieces)?.commit()?,
        Format::Kml => map::stage_map_kml(&args.out, &ways, args.pieces)?.commit()?,
        Format::Gpx => map::stage_map_gpx(&args.out, &ways)?.commit()?,
        Format::Map => map::stage_map_ways(&args.out, &ways)?.commit()?,
        Format::Csv => map::write_ways_csv(&args.out, &args.map, &ways)?,
        Format::Page => map_page::page(&args.map, &ways)
            .stage_alone(&args.out)?
            .commit()?,
    }
    let cells: usize = ways.iter().map(|way| way.rows.len()).sum();
    note(format_args!(
        "{}: {cells} cells, ways: {}",
        on_one_line(&args.out),
        ways.len()
    ));
    Ok(())
}

/// Writes the roads of a road memory as a run.
fn export_memory(args: &Args, format: Format) -> Result<()> {
    if format != Format::Map {
        let problem = "a road memory becomes a run; expected --out NAME.csv or NAME.parquet";
        return Err(Error::Usage(problem.to_owned()));
    }
    let learned = map::read_learned_run(&args.map)?;
    run::write(&args.out, &learned.rows)?;
    note(format_args!(
        "{}: {} cells, roads: {}",
        on_one_line(&args.out),
        learned.rows.len(),
        learned.roads
    ));
    Ok(())
}

impl Args {
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
            _ if self.out.is_dir() => Ok(Format::Csv),
            "csv" | "parquet" => Ok(Format::Map),
            "" if is_written_through(&self.out) => Err(Error::Usage(
                "--out has no ending; expected --format map, geojson, kml, gpx or page".to_owned(),
            )),
            "" => Ok(Format::Csv),
            other => Err(Error::Usage(format!(
                "--out ends in .{other}; expected .csv, .parquet, .geojson, .kml, .gpx, .html, a folder, or --format"
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
