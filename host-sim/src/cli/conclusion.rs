//! The end of a drive, recorded or live: its files, and a summary of it.

use crate::error::Result;
use crate::files::kept;
use crate::files::run::{self, Origin, RunRows};
use crate::files::vehicle::VehicleFile;
use crate::recorder::LongRun;
use crate::terminal::counters::events;
use crate::terminal::table::text_table;
use comfy_table::Table;
use estimator_core::Traction;
use serde::Serialize;
use std::path::Path;

/// Writes what a drive leaves: the run, and what is kept for the next one if there is a file for
/// it, which is written ahead of the run: where that cannot be, neither appears.
pub(super) fn write(
    run: &mut LongRun,
    out: Option<&Path>,
    origin: &Origin,
    kept: Option<&Path>,
) -> Result<()> {
    let keeping = match kept.zip(run.kept.as_ref()) {
        Some((file, kept)) => Some(kept::stage(file, kept)?),
        None => None,
    };
    if let Some(out) = out {
        run::write_rows(out, &mut run.rows, origin)?;
    }
    let is_kept = keeping.is_some();
    if let Some(keeping) = keeping {
        keeping.commit()?;
    }
    if let Some(out) = out {
        eprintln!("wrote {}", out.display());
    }
    if let Some(file) = kept {
        let file = file.display();
        if is_kept {
            eprintln!("kept for the next drive: {file}");
        } else {
            eprintln!("nothing to keep, 5 km with GNSS are needed: {file} is as it was");
        }
    }
    Ok(())
}

/// What the traffic lacked for an estimate; `None` if nothing.
pub(super) fn missing(vehicle: &VehicleFile, run: &LongRun) -> Option<&'static str> {
    let counters = &run.counters;
    let problem = if counters.speeds_used == 0 {
        "no speed: expected wheel-based speed (CCVS1, PGN 65265, or EBC2, PGN 65215; column \
         wheel_speed_mps)"
    } else if run.rows.count() == 0 {
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
        return None;
    };
    Some(problem)
}

/// What a drive came to.
#[derive(Debug, Default, Serialize)]
pub(super) struct Summary {
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
    /// Of a run.
    ///
    /// # Errors
    /// If its rows cannot be had.
    pub(super) fn new(run: &mut LongRun) -> Result<Self> {
        let mut sums = Self {
            cells: run.rows.count(),
            scale: 1.0,
            events: events(&run.counters),
            ..Self::default()
        };
        let (mut first_m, mut last_m) = (None, None);
        run.rows.each(&mut |row| {
            sums.distance_km = row.distance_m * 1e-3;
            sums.duration_s = row.time_s;
            sums.valid_percent += f64::from(row.valid);
            sums.grade_sigma_percent += row.grade_sigma_percent;
            sums.lagged_grade_sigma_percent += row.lagged_grade_sigma_percent;
            sums.live_grade_sigma_percent += row.live_grade_sigma_percent;
            sums.bias_percent += row.bias_percent;
            sums.scale = row.scale;
            first_m = first_m.or(row.altitude_m);
            last_m = row.altitude_m.or(last_m);
            Ok(())
        })?;
        let count = sums.cells.max(1) as f64;
        Ok(Self {
            valid_percent: 100.0 * (sums.valid_percent / count),
            grade_sigma_percent: sums.grade_sigma_percent / count,
            lagged_grade_sigma_percent: sums.lagged_grade_sigma_percent / count,
            live_grade_sigma_percent: sums.live_grade_sigma_percent / count,
            climb_m: last_m.unwrap_or(0.0) - first_m.unwrap_or(0.0),
            bias_percent: sums.bias_percent / count,
            ..sums
        })
    }

    pub(super) fn table(&self) -> Table {
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
