//! The original and the modified method side by side (section 8, tables 5-8, figures 15-18).

use super::comparison::{differences, made_of, summary};
use super::measure::{Errors, errors, merged, rmse};
use super::replica::{Campaign, Experiment, Heading, Replica, inner};
use super::thesis;
use crate::baseline::{Method, Point, Profile, STEP_M};
use crate::error::Result;
use crate::report::page::{Figure, Section, Table};
use crate::report::plot::{Plot, Series, colour, stretches};
use crate::study::{Outcome, Setting, Study};
use rayon::prelude::*;

/// Range of grade errors in the figures, %.
const SHOWN_PERCENT: (f64, f64) = (-1.2, 1.2);

/// The study, for the list.
pub const STUDY: Study = Study {
    name: "modified",
    about: "thesis tables 5-8, figures 15-18: original and modified method on the ten runs",
    run,
};

/// A run estimated by one method.
#[derive(Clone, Debug)]
pub struct Estimated {
    /// Which run.
    pub experiment: Experiment,
    /// Its estimate.
    pub profile: Profile,
    /// Errors of it.
    pub errors: Errors,
    /// RMSE(m): of the map of this and all runs before it in the same direction, %.
    pub rmse_merged: f64,
}

impl Method {
    /// µ, σ, RMSE(v), RMSE(a) and RMSE(m) that the thesis measured in a run.
    #[must_use]
    pub const fn of_thesis(self, experiment: Experiment) -> [f64; 5] {
        let all = match self {
            Self::Original => thesis::original(experiment.heading),
            Self::Modified => thesis::modified(experiment.heading),
        };
        all[experiment.number - 1]
    }

    /// All runs, estimated and merged one by one in each direction.
    #[must_use]
    pub fn apply(self, runs: &[Replica]) -> Vec<Estimated> {
        let profiles: Vec<Profile> = runs
            .par_iter()
            .map(|run| self.estimate(&run.drive))
            .collect();
        let mut found: Vec<Estimated> = Vec::new();
        for (run, profile) in runs.iter().zip(profiles) {
            let mut members: Vec<&Profile> = found
                .iter()
                .filter(|before| before.experiment.heading == run.experiment.heading)
                .map(|before| &before.profile)
                .collect();
            members.push(&profile);
            found.push(Estimated {
                experiment: run.experiment,
                errors: errors(run, &profile.grade_percent),
                rmse_merged: rmse(&run.truth, &merged(&members)),
                profile,
            });
        }
        found
    }
}

fn run(setting: &Setting) -> Result<Outcome> {
    let campaign = Campaign::new(setting.seed);
    let runs = campaign.replicas();
    let [original, modified] = Method::BOTH.map(|method| method.apply(&runs));
    let mut tables = vec![
        table("table5", Method::Modified, Heading::South, &modified),
        table("table6", Method::Modified, Heading::North, &modified),
        table("table7", Method::Original, Heading::South, &original),
        table("table8", Method::Original, Heading::North, &original),
    ];
    let compared = summary(&original, &modified);
    tables.push(compared.table());
    tables.push(made_of(&campaign, &runs));
    let mut words = words();
    words.extend(differences(&compared));
    Ok(Outcome::Done(Section {
        heading: "Original and modified method (thesis 8)".to_owned(),
        words,
        tables,
        figures: figures(&runs, &original, &modified),
    }))
}

fn words() -> Vec<String> {
    vec![
        "Predicted, not fitted: σ and all RMSE of tables 5-8, with the noise of the filters as \
         chosen on training runs (study tuning, which also tells what other choices gave). µ of the original method follows from the \
         pointwise µ, which is fitted, and from the share of it that the noise leaves, which was \
         chosen as the thesis's. First and last 200 points are left out; RMSE(v) is over points \
         without shifts and braking, RMSE(a) over all, RMSE(m) over all points of the map of this \
         run and those before it, weighted by 1/P."
            .to_owned(),
    ]
}

fn table(name: &str, method: Method, heading: Heading, all: &[Estimated]) -> Table {
    let header = [
        "run",
        "µ %",
        "thesis",
        "σ %",
        "thesis",
        "RMSE(v) %",
        "thesis",
        "RMSE(a) %",
        "thesis",
        "RMSE(m) %",
        "thesis",
    ];
    let caption = format!(
        "Error of the {} method, {} (thesis table {}).",
        method.word(),
        heading.word(),
        name.trim_start_matches("table")
    );
    let rows = all
        .iter()
        .filter(|found| found.experiment.heading == heading)
        .map(|found| {
            let Errors {
                mu,
                sigma,
                rmse_valid,
                rmse_all,
            } = found.errors;
            let ours = [mu, sigma, rmse_valid, rmse_all, found.rmse_merged];
            let mut row = vec![found.experiment.number.to_string()];
            for (ours, thesis) in ours.into_iter().zip(method.of_thesis(found.experiment)) {
                row.push(format!("{ours:.4}"));
                row.push(format!("{thesis:.4}"));
            }
            row
        });
    Table::new(name, caption, &header).with_rows(rows)
}

fn figures(runs: &[Replica], original: &[Estimated], modified: &[Estimated]) -> Vec<Figure> {
    // Northbound run 3, northbound run 4, the first three merged, all five merged.
    let shown = [
        (
            "fig15",
            "Figure 15",
            "error in northbound 3 (truck A)",
            3..=3,
        ),
        (
            "fig16",
            "Figure 16",
            "error in northbound 4 (truck B)",
            4..=4,
        ),
        (
            "fig17",
            "Figure 17",
            "error of the map of the three northbound runs of truck A",
            1..=3,
        ),
        (
            "fig18",
            "Figure 18",
            "error of the map of all five northbound runs",
            1..=5,
        ),
    ];
    let mut figures = Vec::new();
    for (name, number, what, wanted) in shown {
        for (method, all) in Method::BOTH.into_iter().zip([original, modified]) {
            let chosen: Vec<(&Replica, &Estimated)> = runs
                .iter()
                .zip(all)
                .filter(|(run, _)| run.experiment.heading == Heading::North)
                .filter(|(run, _)| wanted.contains(&run.experiment.number))
                .collect();
            figures.extend(error_figure(
                &format!("{name}_{}", method.word()),
                &format!("{number}, {} method: {what}.", method.word()),
                &chosen,
            ));
        }
    }
    figures
}

/// Error over distance of the map of some runs, or of a single one. Braking in any of them is
/// shaded, shifts in any of them are marked on the axis.
fn error_figure(name: &str, caption: &str, runs: &[(&Replica, &Estimated)]) -> Option<Figure> {
    let (first, _) = runs.first()?;
    let profiles: Vec<&Profile> = runs.iter().map(|(_, found)| &found.profile).collect();
    let grade = merged(&profiles);
    let km = |k: usize| k as f64 * STEP_M * 1e-3;
    let any =
        |k: usize, of: fn(&Point) -> bool| runs.iter().any(|(run, _)| of(&run.drive.points[k]));
    let error = inner(first).map(|k| (km(k), grade[k] - first.truth[k]));
    let mut plot =
        Plot::new("distance (km)", "grade error (%)").with(Series::line("", colour::BLUE, error));
    plot.shaded = stretches(inner(first).map(|k| (km(k), any(k, |point| point.braking))));
    plot.ticks = inner(first)
        .filter(|&k| any(k, |point| point.shifting) && !any(k - 1, |point| point.shifting))
        .map(km)
        .collect();
    plot.y_range = Some(SHOWN_PERCENT);
    plot.height = 240;
    let error = rmse(&first.truth, &grade);
    let caption =
        format!("{caption} RMSE {error:.3} %. Grey: braking; marks on the axis: gear shifts.");
    Some(Figure::new(name, &plot, caption))
}
