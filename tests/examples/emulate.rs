//! Runs a log through the firmware on the emulated board:
//!
//!     cargo run --release -p cross-tests --example emulate -- --vehicle V.toml --out CELLS.csv LOG
//!
//! builds the image, runs it on the frames, prints its log, compares its cells bit for bit with
//! those of the estimator on this machine, and writes them.

use clap::Parser;
use cross_tests::emulator::{drive_file, missing, on_host, replay};
use cross_tests::exit_code;
use estimator_core::Cell;
use firmware::exchange::cell::{self, CELL_BYTES};
use host_sim::error::{Error, Result};
use host_sim::files::output::write_whole;
use host_sim::files::vehicle::VehicleFile;
use host_sim::source::input::{LogInput, for_each_input};
use host_sim::source::read_options::ReadOptions;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

/// Runs a log through the estimator on an emulated Cortex-M4F.
#[derive(Debug, Parser)]
struct Args {
    /// The vehicle.
    #[arg(long, value_name = "V.toml")]
    vehicle: PathBuf,
    /// File for the cells of the board.
    #[arg(long, value_name = "CELLS.csv")]
    out: PathBuf,
    /// A candump log.
    log: PathBuf,
}

fn main() -> ExitCode {
    exit_code(run(&Args::parse()))
}

fn run(args: &Args) -> Result<()> {
    if let Some(what) = missing() {
        return Err(Error::content(Path::new("emulated board"), what));
    }
    let vehicle = VehicleFile::read(&args.vehicle)?;
    let mut frames = Vec::new();
    for_each_input(
        &args.log,
        &ReadOptions::default(),
        |_| (),
        |input| {
            if let LogInput::Frame(frame) = input {
                frames.push(frame);
            }
        },
    )?;
    if frames.is_empty() {
        let problem = "no frames in it; expected a candump log";
        return Err(Error::content(&args.log, problem.to_owned()));
    }
    let ended = replay(Some(&drive_file(&vehicle.model, &frames)), None);
    for line in &ended.log {
        println!("{line}");
    }
    if ended.status != Some(0) {
        return Err(Error::content(&args.log, ended.stderr));
    }
    let cells = ended.cells.unwrap_or_default();
    let on_host: Vec<u8> = on_host(&vehicle.model, &frames)
        .iter()
        .flat_map(cell::encode)
        .collect();
    if cells != on_host {
        let problem = "the board's cells are not those of this machine";
        return Err(Error::content(&args.log, problem.to_owned()));
    }
    println!("each cell is that of this machine, bit for bit");
    write_whole(&args.out, |out| {
        writeln!(
            out,
            "distance_m,time_us,latitude_deg,longitude_deg,live_grade_percent,\
             live_sigma_percent,lagged_grade_percent,lagged_sigma_percent,altitude_m"
        )?;
        cells
            .chunks(CELL_BYTES)
            .filter_map(cell::decode)
            .try_for_each(|cell| writeln!(out, "{}", row(&cell)))
    })
}

fn row(cell: &Cell) -> String {
    let degrees =
        |e7: Option<i32>| e7.map_or(String::new(), |e7| format!("{:.7}", f64::from(e7) * 1e-7));
    let position = cell.end.position_e7;
    let altitude = cell
        .altitude_m
        .map(|altitude| format!("{:.2}", altitude.value));
    format!(
        "{:.1},{},{},{},{:.4},{:.4},{:.4},{:.4},{}",
        cell.end.distance_m(),
        cell.end.time.micros(),
        degrees(position.map(|(latitude, _)| latitude)),
        degrees(position.map(|(_, longitude)| longitude)),
        cell.live_grade_percent.value,
        cell.live_grade_percent.sigma,
        cell.lagged_grade_percent.value,
        cell.lagged_grade_percent.sigma,
        altitude.unwrap_or_default()
    )
}
