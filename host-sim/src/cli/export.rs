//! `roadgrade export`.

use crate::error::{Error, Result};
use crate::map;
use crate::report::map_page;
use std::path::PathBuf;

/// Arguments of `export`.
#[derive(Debug, clap::Args)]
#[command(
    after_help = "GeoJSON (RFC 7946, WGS 84): a line for each stretch of a way without a hole, with its length, \
    mean grade and mean sigma, and arrays with the values of each of its positions: distances_m, \
    grades_percent, grade_sigmas_percent, altitudes_m, runs. With --pieces the lines are short and \
    carry numbers only: what QGIS and geopandas colour by grade_percent. A sigma of a piece is the \
    mean of its cells': neighbours err alike.\n\n\
    CSV: a folder with WAY.csv for each way (WAY.backward.csv against its points), each a map by \
    itself; what a file name cannot bear in a way's name becomes _.\n\n\
    Page: one HTML file with the map in plan, coloured by grade and by sigma, and along the ways \
    grade with two sigmas, sigma, and number of runs.\n\n\
    Examples:\n  \
    roadgrade export map.parquet --out map.geojson --pieces 50\n  \
    roadgrade export map.parquet --out map.html\n  \
    roadgrade export map.csv --out ways"
)]
pub struct Args {
    /// A map, as `fuse` wrote it.
    #[arg(value_name = "MAP")]
    map: PathBuf,
    /// Where it goes: NAME.geojson, NAME.html, or a folder for a CSV file a way.
    #[arg(long, value_name = "FILE|DIR")]
    out: PathBuf,
    /// What to write [default: what the name of --out says].
    #[arg(long, value_enum)]
    format: Option<Format>,
    /// Lines of this length (GeoJSON), m; 2.5 is a line from each cell to the next.
    #[arg(long, value_name = "METRES", value_parser = metres)]
    pieces: Option<f64>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
enum Format {
    Geojson,
    Csv,
    Page,
}

/// Runs it.
pub fn run(args: &Args) -> Result<()> {
    let format = args.format()?;
    if args.pieces.is_some() && format != Format::Geojson {
        let problem = "--pieces is for GeoJSON; expected --out NAME.geojson with it";
        return Err(Error::Usage(problem.to_owned()));
    }
    let ways = map::read_map_ways(&args.map)?;
    match format {
        Format::Geojson => map::stage_map_geojson(&args.out, &ways, args.pieces)?.commit()?,
        Format::Csv => map::write_ways_csv(&args.out, &args.map, &ways)?,
        Format::Page => map_page::page(&args.map, &ways)
            .stage_alone(&args.out)?
            .commit()?,
    }
    let cells: usize = ways.iter().map(|way| way.rows.len()).sum();
    eprintln!(
        "{}: {cells} cells, ways: {}",
        args.out.display(),
        ways.len()
    );
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
            "html" | "htm" => Ok(Format::Page),
            "" => Ok(Format::Csv),
            _ if self.out.is_dir() => Ok(Format::Csv),
            other => Err(Error::Usage(format!(
                "--out ends in .{other}; expected .geojson, .html, a folder, or --format"
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
            "expected {} m, the length of a cell, or more",
            map::GRID_M
        ))
    }
}
