//! `roadgrade estimate`: one recorded drive becomes a run.

use crate::error::{Error, Result};
use crate::events::events;
use crate::kept_file;
use crate::output::print;
use crate::progress;
use crate::recorder::{self, Run};
use crate::run_file;
use crate::smooth::bytes_per_km;
use crate::text_table::text_table;
use crate::vehicle_file::VehicleFile;
use comfy_table::Table;
use estimator_core::{Kept, Scalar, Traction};
use serde::Serialize;
use std::path::{Path, PathBuf};
use std::time::Instant as Clock;

/// Arguments of `estimate`.
#[derive(Debug, clap::Args)]
#[command(after_help = "\
Needed on the bus: wheel speed (CCVS1 or EBC2), engine torque (EEC1) and friction (EEC3), the gear \
(ETC2; or engine speed, from which it is told), GNSS altitude (129029, or VDS). `roadgrade inspect \
LOG` tells what a log has. In a signal table the same by the names of its columns.

RUN.csv has one row for each 2.5 m: grade in % (smoothed over the whole run, lagged by 500 m, \
live), each with its standard deviation, position, altitude, and what the vehicle model was found \
to be off by.

--kept FILE is the vehicle's memory from one drive to the next, as its ECU would have it: what the model was found to be off by, and how noisy the sensors were, so that the first kilometres are better. Where there is no FILE yet, the drive begins as without. Estimate the drives once each, in the order in which they were driven. A FILE that is damaged, or that another vehicle or an edited V.toml left, is refused: then remove it, or give the vehicle another. Wind, cold tyres and a load that may have changed are allowed for; a drive with less than 5 km leaves FILE as it was.")]
pub struct Args {
    /// Vehicle parameters.
    #[arg(long, value_name = "V.toml")]
    vehicle: PathBuf,
    /// Where the run goes.
    #[arg(long, value_name = "RUN.csv")]
    out: PathBuf,
    /// What the vehicle's last drive left, and what this one leaves for the next.
    #[arg(long, value_name = "FILE")]
    kept: Option<PathBuf>,
    /// Compute in double instead of single precision.
    #[arg(long)]
    double: bool,
    /// Print the summary as JSON.
    #[arg(long)]
    json: bool,
    /// candump log (either layout, also .gz), or signal table (.csv, also .csv.gz).
    log: PathBuf,
}

/// Runs it.
pub fn run(args: &Args) -> Result<()> {
    let vehicle = VehicleFile::read(&args.vehicle)?;
    let started = Clock::now();
    let file = args.kept.as_deref();
    let last = match file {
        Some(file) => kept_file::read(file, &vehicle.parameters)?,
        None => None,
    };
    let last = last.as_ref();
    let run = if args.double {
        drive::<f64>(&vehicle, last, &args.log)?
    } else {
        drive::<f32>(&vehicle, last, &args.log)?
    };
    let seconds = started.elapsed().as_secs_f64();
    check(&args.log, &vehicle, &run)?;
    let keeping = match file.zip(run.kept.as_ref()) {
        Some((file, kept)) => Some(kept_file::stage(file, kept)?),
        None => None,
    };
    run_file::write(&args.out, &run.rows)?;
    let is_kept = keeping.is_some();
    if let Some(keeping) = keeping {
        keeping.commit()?;
    }

    let summary = Summary::new(&run);
    if args.json {
        let json = serde_json::to_string(&summary).expect("numbers are JSON");
        print(&format!("{json}\n"))?;
    } else {
        print(&format!("{}\n", summary.table()))?;
    }
    let frames = run.counters.frames;
    if frames > 0 {
        eprintln!(
            "{frames} frames in {seconds:.2} s, {:.0} frames/s",
            frames as f64 / seconds
        );
    }
    eprintln!("whole-run smoothing held {} kB a km", bytes_per_km() / 1000);
    eprintln!("wrote {}", args.out.display());
    if let Some(file) = file {
        let file = file.display();
        if is_kept {
            eprintln!("kept for the next drive: {file}");
        } else {
            eprintln!("nothing to keep, 5 km with GNSS are needed: {file} is as it was");
        }
    }
    Ok(())
}

/// Estimates one log, with a progress bar on long ones.
pub(super) fn drive<S: Scalar>(
    vehicle: &VehicleFile,
    last: Option<&Kept>,
    log: &Path,
) -> Result<Run> {
    let bar = progress::bytes(log.metadata().map_or(0, |file| file.len()));
    let progress = |read| bar.set_position(read);
    let run = recorder::estimate_log::<S>(&vehicle.parameters, last, log, progress);
    bar.finish_and_clear();
    run
}

/// Whether the log held what an estimate needs; if not, what is missing.
pub(super) fn check(log: &Path, vehicle: &VehicleFile, run: &Run) -> Result<()> {
    let counters = &run.counters;
    let problem = if counters.speeds_used == 0 {
        "no speed: expected wheel-based speed (CCVS1, PGN 65265, or EBC2, PGN 65215; column \
         wheel_speed_mps)"
    } else if run.rows.is_empty() {
        "the vehicle never moved: no grade to estimate"
    } else if counters.tractions_used == 0 {
        match vehicle.parameters.traction {
            Traction::Powertrain(_) => {
                "no engine torque with a known gear: expected EEC1 (PGN 61444; column \
                 engine_torque_percent) and ETC2 (PGN 61445; column gear or gear_ratio) or engine \
                 speed"
            }
            Traction::Force => {
                "no traction force: expected column traction_force_n, as [traction] source = \
                 \"force\" in the vehicle file says"
            }
        }
    } else if counters.altitudes_used == 0 {
        "no GNSS altitude: expected NMEA 2000 129029 (or VDS, PGN 65256; column altitude_m)"
    } else {
        return Ok(());
    };
    Err(Error::content(log, problem))
}

#[derive(Debug, Serialize)]
struct Summary {
    distance_km: f64,
    duration_s: f64,
    cells: usize,
    valid_percent: f64,
    grade_sigma_percent: f64,
    lagged_grade_sigma_percent: f64,
    live_grade_sigma_percent: f64,
    climb_m: f64,
    bias_percent: f64,
    scale: f64,
    events: Vec<(&'static str, u64)>,
}

impl Summary {
    fn new(run: &Run) -> Self {
        let rows = &run.rows;
        let mean = |f: &dyn Fn(&run_file::RunRow) -> f64| {
            rows.iter().map(f).sum::<f64>() / rows.len().max(1) as f64
        };
        let altitudes = || rows.iter().filter_map(|row| row.altitude_m);
        Self {
            distance_km: rows.last().map_or(0.0, |row| row.distance_m * 1e-3),
            duration_s: rows.last().map_or(0.0, |row| row.time_s),
            cells: rows.len(),
            valid_percent: 100.0 * mean(&|row| row.valid.into()),
            grade_sigma_percent: mean(&|row| row.grade_sigma_percent),
            lagged_grade_sigma_percent: mean(&|row| row.lagged_grade_sigma_percent),
            live_grade_sigma_percent: mean(&|row| row.live_grade_sigma_percent),
            climb_m: altitudes().next_back().unwrap_or(0.0) - altitudes().next().unwrap_or(0.0),
            bias_percent: mean(&|row| row.bias_percent),
            scale: rows.last().map_or(1.0, |row| row.scale),
            events: events(&run.counters),
        }
    }

    fn table(&self) -> Table {
        let mut rows = Vec::new();
        let mut line = |name: &str, value: String, unit: &str| {
            rows.push(vec![name.to_owned(), unit.to_owned(), value]);
        };
        line("distance", format!("{:.3}", self.distance_km), "km");
        line("duration", format!("{:.1}", self.duration_s), "s");
        line("cells", self.cells.to_string(), "");
        line("valid", format!("{:.1}", self.valid_percent), "%");
        line("climb", format!("{:.1}", self.climb_m), "m");
        let grade = "% grade";
        line(
            "sigma, smoothed",
            format!("{:.3}", self.grade_sigma_percent),
            grade,
        );
        line(
            "sigma, lagged",
            format!("{:.3}", self.lagged_grade_sigma_percent),
            grade,
        );
        line(
            "sigma, live",
            format!("{:.3}", self.live_grade_sigma_percent),
            grade,
        );
        line(
            "model bias, mean",
            format!("{:+.3}", self.bias_percent),
            grade,
        );
        line("traction scale, end", format!("{:.3}", self.scale), "");
        for (name, count) in &self.events {
            line(name, count.to_string(), "");
        }
        text_table(&["", "unit", "value"], &rows, 2)
    }
}
