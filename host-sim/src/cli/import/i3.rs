//! `roadgrade import i3`.

use crate::cli::outputs;
use crate::error::{Error, Result, on_one_line};
use crate::source::i3::{Trip, vehicle};
use crate::terminal::print::{note, print};
use crate::terminal::table::text_table;
use comfy_table::Table;
use serde::Serialize;
use std::path::{Path, PathBuf};

/// Arguments of `import i3`.
#[derive(Debug, clap::Args)]
pub(super) struct Args {
    /// Files of the trips, plain or gzip.
    #[arg(required = true, value_name = "FILE")]
    files: Vec<PathBuf>,
    /// Output folder.
    #[arg(long)]
    out: PathBuf,
    /// Print the trips as JSON.
    #[arg(long)]
    json: bool,
}

#[derive(Serialize)]
struct TripSummary {
    name: String,
    rows: usize,
    duration_s: f64,
    length_m: f64,
    altitudes: usize,
    ambient_celsius: Option<f64>,
    file: PathBuf,
}

/// Runs the command.
pub(super) fn run(args: &Args) -> Result<()> {
    // All trips are read before the first file is written.
    let trips = args
        .files
        .iter()
        .map(|file| Trip::read(file))
        .collect::<Result<Vec<Trip>>>()?;
    let summaries: Vec<TripSummary> = trips.iter().map(|trip| summary(trip, &args.out)).collect();
    check_names(&args.files, &summaries)?;
    let vehicle_file = args.out.join("vehicle.toml");
    let written = summaries.iter().map(|trip| &*trip.file);
    outputs::check(
        args.files.iter().map(PathBuf::as_path),
        written.chain([&*vehicle_file]),
    )?;
    for (trip, summary) in trips.iter().zip(&summaries) {
        trip.write(&summary.file)?;
    }
    vehicle().write(&vehicle_file)?;
    for (trip, file) in trips.iter().zip(&args.files) {
        for problem in trip.notes() {
            note(format_args!("{}: {problem}", on_one_line(file)));
        }
    }
    if args.json {
        print(&format!(
            "{:#}\n",
            serde_json::json!({ "trips": summaries })
        ))
    } else {
        print(&format!("{}\n", table(&summaries)))
    }
}

/// Checks that each trip has a name of its own.
fn check_names(files: &[PathBuf], trips: &[TripSummary]) -> Result<()> {
    for (k, (file, trip)) in files.iter().zip(trips).enumerate() {
        if let Some(same) = trips[..k].iter().position(|other| other.name == trip.name) {
            let problem = format!(
                "is trip {} as {} is; expected another name",
                trip.name,
                on_one_line(&files[same])
            );
            return Err(Error::content(file, problem));
        }
    }
    Ok(())
}

fn summary(trip: &Trip, out: &Path) -> TripSummary {
    let rows = trip.rows();
    let time_s = |row: Option<&crate::source::i3::TripRow>| row.map_or(0.0, |row| row.time_s);
    TripSummary {
        name: trip.name().to_owned(),
        rows: rows.len(),
        duration_s: time_s(rows.last()) - time_s(rows.first()),
        length_m: trip.length_m(),
        altitudes: rows.iter().filter(|row| row.altitude_m.is_some()).count(),
        ambient_celsius: trip.ambient_celsius(),
        file: out.join(format!("{}.csv", trip.name())),
    }
}

fn table(trips: &[TripSummary]) -> Table {
    let rows: Vec<Vec<String>> = trips
        .iter()
        .map(|trip| {
            vec![
                trip.name.clone(),
                on_one_line(&trip.file).to_string(),
                trip.rows.to_string(),
                format!("{:.0}", trip.duration_s),
                format!("{:.0}", trip.length_m),
                trip.altitudes.to_string(),
                trip.ambient_celsius
                    .map_or("-".to_owned(), |celsius| format!("{celsius:.1}")),
            ]
        })
        .collect();
    let header = [
        "trip",
        "file",
        "rows",
        "duration s",
        "length m",
        "altitudes",
        "ambient °C",
    ];
    text_table(&header, &rows, 2)
}
