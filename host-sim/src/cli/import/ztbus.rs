//! `roadgrade import ztbus`.

use crate::cli::outputs;
use crate::error::{Result, on_one_line};
use crate::source::ztbus::{Mission, Pass};
use crate::terminal::print::{note, print};
use crate::terminal::table::text_table;
use comfy_table::Table;
use serde::Serialize;
use std::path::{Path, PathBuf};

/// Arguments of `import ztbus`.
#[derive(Debug, clap::Args)]
pub(super) struct Args {
    /// CSV file of the mission.
    file: PathBuf,
    /// Output folder.
    #[arg(long)]
    out: PathBuf,
    /// Print the passes as JSON.
    #[arg(long)]
    json: bool,
}

#[derive(Serialize)]
struct MissionSummary {
    rows: usize,
    duration_s: f64,
    length_m: f64,
    first_fix_s: f64,
    passes: Vec<PassSummary>,
}

#[derive(Serialize)]
struct PassSummary {
    number: usize,
    direction: &'static str,
    start_s: f64,
    duration_s: f64,
    length_m: f64,
    climb_m: Option<f64>,
    passengers_mean: Option<f64>,
    file: PathBuf,
}

/// Runs the command.
pub(super) fn run(args: &Args) -> Result<()> {
    // The whole mission is read and split before the first file is written.
    let mission = Mission::read(&args.file)?;
    let passes = mission.passes();
    let summary = summary(&mission, &passes, &args.out);
    let mut written = vec![args.out.join("mission.csv"), args.out.join("vehicle.toml")];
    written.extend(summary.passes.iter().map(|pass| pass.file.clone()));
    outputs::check([&*args.file], written.iter().map(PathBuf::as_path))?;
    mission.write(&args.out.join("mission.csv"))?;
    for (pass, summary) in passes.iter().zip(&summary.passes) {
        mission.write_pass(&summary.file, pass)?;
    }
    mission.vehicle().write(&args.out.join("vehicle.toml"))?;
    if args.json {
        print(&format!("{:#}\n", serde_json::json!(summary)))?;
    } else {
        print(&format!("{}\n", table(&summary.passes)))?;
    }
    note(format_args!(
        "{}: {:.1} km in {:.0} min, first fix after {:.0} s; mission.csv, vehicle.toml and {} \
         passes are in {}",
        on_one_line(&args.file),
        summary.length_m / 1000.0,
        summary.duration_s / 60.0,
        summary.first_fix_s,
        passes.len(),
        on_one_line(&args.out)
    ));
    Ok(())
}

fn summary(mission: &Mission, passes: &[Pass], out: &Path) -> MissionSummary {
    let rows = mission.rows();
    MissionSummary {
        rows: rows.len(),
        duration_s: rows.last().map_or(0.0, |row| row.time_s),
        length_m: mission.odometer_m().last().copied().unwrap_or(0.0),
        first_fix_s: rows[mission.first_fix()].time_s,
        passes: passes
            .iter()
            .zip(1..)
            .map(|(pass, number)| {
                let direction = pass.direction.word();
                PassSummary {
                    number,
                    direction,
                    start_s: pass.start_s,
                    duration_s: pass.duration_s,
                    length_m: pass.length_m,
                    climb_m: pass.climb_m,
                    passengers_mean: pass.passengers_mean,
                    file: out.join(format!("pass_{number:02}_{direction}.csv")),
                }
            })
            .collect(),
    }
}

fn table(passes: &[PassSummary]) -> Table {
    let optional = |value: Option<f64>| value.map_or("-".to_owned(), |v| format!("{v:.1}"));
    let rows: Vec<Vec<String>> = passes
        .iter()
        .map(|pass| {
            vec![
                pass.number.to_string(),
                pass.direction.to_owned(),
                on_one_line(&pass.file).to_string(),
                format!("{:.0}", pass.start_s),
                format!("{:.0}", pass.duration_s),
                format!("{:.0}", pass.length_m),
                optional(pass.climb_m),
                optional(pass.passengers_mean),
            ]
        })
        .collect();
    let header = [
        "pass",
        "direction",
        "file",
        "start s",
        "duration s",
        "length m",
        "climb m",
        "passengers",
    ];
    text_table(&header, &rows, 3)
}
