//! `roadgrade horizon`: the grade ahead, along a recorded drive.

use super::log_files;
use super::log_options::LogOptions;
use super::outputs;
use super::told::Told;
use crate::error::{Error, Result};
use crate::files::csv::CsvTable;
use crate::files::vehicle::VehicleFile;
use crate::map::open_packed_map;
use crate::recorder::horizons_of_log;
use crate::terminal::progress;
use serde_json::json;
use std::path::PathBuf;

/// Arguments of `horizon`.
#[derive(Debug, clap::Args)]
#[command(
    after_help = "Example:\n  roadgrade horizon --map map.grade --vehicle V.toml --out ahead.csv drive.log",
    after_long_help = "HORIZON.csv has, for every second in which the place on the map is known, the grade ahead \
    every 25 m. Branch 0 is the most probable path; other branches begin where they leave it. \
    Columns: time_s, distance_m (driven), branch, probability, ahead_m, grade_percent, \
    grade_sigma_percent.\n\n\
    Example:\n  \
    roadgrade horizon --map map.grade --vehicle vehicle.toml --out ahead.csv mon.log"
)]
pub struct Args {
    /// Packed map, as `pack` writes it.
    #[arg(long, value_name = "MAP.grade")]
    map: PathBuf,
    /// Vehicle parameters.
    #[arg(long, value_name = "V.toml")]
    vehicle: PathBuf,
    /// File for the grade ahead.
    #[arg(long, value_name = "HORIZON.csv")]
    out: PathBuf,
    /// Length of the horizon, m.
    #[arg(long, value_name = "METRES", default_value_t = 2000.0, value_parser = length)]
    length: f32,
    #[command(flatten)]
    reading: LogOptions,
    /// Print what was written as JSON.
    #[arg(long, hide_short_help = true)]
    json: bool,
    /// Log of frames or signal table, as for `estimate`.
    log: PathBuf,
}

/// Runs the command.
pub fn run(args: &Args) -> Result<()> {
    let options = args.reading.read_options()?;
    let log = &log_files::one(&args.log, &options)?;
    let inputs = [log, &*args.vehicle, &*args.map];
    let inputs = inputs.into_iter().chain(args.reading.files());
    outputs::check(inputs, [&*args.out])?;
    outputs::check_file(&args.out, &["csv"])?;
    let vehicle = VehicleFile::read(&args.vehicle)?;
    let map = open_packed_map(&args.map)?;
    let bar = progress::bytes(log.metadata().map_or(0, |file| file.len()));
    let mut table = CsvTable::begin(&args.out)?;
    let (mut rows, mut seconds, mut newest_s) = (0_u64, 0_u64, None);
    let read = horizons_of_log(
        &vehicle.model,
        map,
        args.length,
        log,
        &options,
        |read| bar.set_position(read),
        |row| {
            rows += 1;
            seconds += u64::from(newest_s.replace(row.time_s) != Some(row.time_s));
            table.push(row)
        },
    );
    bar.finish_and_clear();
    read?;
    if rows == 0 {
        let problem = "is never on the map; expected a drive over its ways";
        return Err(Error::content(log, problem));
    }
    table.finish()?.commit()?;
    let told = Told {
        words: format!("the grade ahead at {seconds} times, {rows} rows"),
        json: json!({ "times": seconds, "rows": rows }),
    };
    told.tell(&args.out, args.json)
}

fn length(argument: &str) -> std::result::Result<f32, String> {
    argument
        .parse()
        .ok()
        .filter(|metres| (25.0..=20_000.0).contains(metres))
        .ok_or_else(|| "expected 25 to 20000 m".to_owned())
}
