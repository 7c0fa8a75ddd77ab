//! A measured truck on a closed track: errors of the grade, what repeats by place, and what explains it.
//!
//! The altitude is known once a lap, so in between the forces alone make the grade: a test of the vehicle
//! model. The reference is the mean grade of eleven laps by the truck's own GNSS, by place on the lap.

mod estimates;
pub mod laps;
mod place_effects;

use super::definition::{Setting, Study, StudyOutcome};
use crate::error::Result;
use crate::files::vehicle::VehicleFile;
use crate::report::page::{Figure, Section, Table};
use crate::report::plot::{Plot, Series, colour};
use estimates::{Estimate, estimates};
use laps::{LapError, Laps, rmse};
use place_effects::{PLACE_EFFECTS, explained};
use std::path::Path;

/// Lengths of windows, m.
const WINDOWS_M: [f64; 3] = [100.0, 300.0, 600.0];
/// Windows in which sigmas are checked, m.
const NEES_WINDOW_M: f64 = 300.0;

/// The study, for the list.
pub const STUDY: Study = Study {
    name: "track",
    about: "a measured truck on a closed track: errors, what repeats by place, and what explains it",
    run,
};

fn run(setting: &Setting) -> Result<StudyOutcome> {
    let folder = setting.data.join("peterbilt");
    if !folder.exists() {
        return Ok(StudyOutcome::Skipped(format!(
            "{} is missing; expected the laps of a measured truck (--data DIR)",
            folder.display()
        )));
    }
    let laps = Laps::read(&folder)?;
    let vehicle = VehicleFile::read(&folder.join("vehicle.toml"))?;
    let estimates = estimates(&folder.join("laps_1_to_6.csv.gz"), &vehicle)?;
    Ok(StudyOutcome::Done(section(&laps, &estimates, &folder)))
}

fn section(laps: &Laps, estimates: &[Estimate], folder: &Path) -> Section {
    let words = format!(
        "Six laps of 6,686 m by a truck of 29.5 t in a platoon, nearly level, at 29 m/s ({}). The first \
         2.5 km are left out. The reference scatters from lap to lap by 0.035 % over 100 m. What repeats by \
         place is of the vehicle, the wind or the reference; what does not is random.",
        folder.display()
    );
    Section::new("A measured truck on a track")
        .paragraph(words)
        .table(error_table(laps, estimates))
        .table(effect_table(laps, estimates))
        .figure(residual_figure(laps, estimates))
}

fn error_table(laps: &Laps, estimates: &[Estimate]) -> Table {
    let header = [
        "estimate",
        "100 m %",
        "300 m %",
        "600 m %",
        "100 m: repeats by place %",
        "does not %",
        "NEES, 300 m",
    ];
    let row = |estimate: &Estimate| {
        let over = |length_m| laps.errors(&estimate.cells, length_m);
        let (repeats, random) = laps::split(&over(WINDOWS_M[0]));
        let mut row = vec![estimate.name.to_owned()];
        row.extend(WINDOWS_M.map(|length_m| number(rmse(&over(length_m)))));
        row.extend([number(repeats), number(random)]);
        let nees = laps::nees(&over(NEES_WINDOW_M));
        row.push(nees.map_or(String::new(), |nees| format!("{nees:.2}")));
        row
    };
    let caption = "Errors of the mean grade over windows, RMSE.";
    Table::new("track_errors", caption, &header).with_rows(estimates.iter().map(row))
}

/// Fits effects by place on four laps, and judges them on the other two.
fn effect_table(laps: &Laps, estimates: &[Estimate]) -> Table {
    let mut rows = Vec::new();
    for estimate in estimates.iter().filter(|of| of.is_of_the_vehicle) {
        let errors = laps.errors(&estimate.cells, WINDOWS_M[0]);
        let (fitted, judged): (Vec<LapError>, Vec<LapError>) = errors
            .into_iter()
            .partition(|error| error.lap < laps.count() - 2);
        for effect in &PLACE_EFFECTS {
            let Some(found) = explained(effect, laps.length_m(), &fitted, &judged) else {
                continue;
            };
            rows.push(vec![
                estimate.name.to_owned(),
                effect.name.to_owned(),
                found.amounts,
                number(rmse(&judged)),
                number(found.judged_rmse),
            ]);
        }
    }
    let header = ["estimate", "effect", "amount %", "before %", "after %"];
    let caption = "Effects by place, fitted on laps 1 to 4, and the error over 100 m on laps 5 and 6 before \
                   and after. A headwind from one direction is a first harmonic over the lap (0.053 % a m/s), two bends are a \
                   second one.";
    Table::new("track_effects", caption, &header).with_rows(rows)
}

fn residual_figure(laps: &Laps, estimates: &[Estimate]) -> Figure {
    let mut plot = Plot::new("place on the lap (km)", "bare model less reference (%)");
    let bare = estimates.iter().find(|of| of.name == estimates::BARE);
    let errors = bare.map_or_else(Vec::new, |of| laps.errors(&of.cells, WINDOWS_M[0]));
    for lap in 0..laps.count() {
        let of_lap = errors.iter().filter(|error| error.lap == lap);
        let points = of_lap.map(|error| (1e-3 * error.place_m, error.error_percent));
        let colour = colour::CYCLE[lap % colour::CYCLE.len()];
        plot = plot.with(Series::line(format!("lap {}", lap + 1), colour, points));
    }
    Figure::new(
        "track_residual",
        &plot,
        "The residual of the bare model, lap upon lap.",
    )
}

fn number(value: f64) -> String {
    if value.is_finite() {
        format!("{value:.3}")
    } else {
        String::new()
    }
}
