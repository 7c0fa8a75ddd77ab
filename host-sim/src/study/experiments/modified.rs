//! The original and the modified method (section 8, tables 5-8, figures 15-18), and ours on the
//! same drives.

use super::beside;
use super::campaign::Campaign;
use super::comparison::{differences, made_of, summary};
use super::heading::Heading;
use super::measure::{RunErrors, inner, merged, rmse};
use super::method::{Estimated, ThesisMethod};
use super::replica::Replica;
use crate::comparison::{MeasuredPoint, Profile, STEP_M};
use crate::error::Result;
use crate::report::page::{Figure, Section, Table};
use crate::report::plot::{Plot, Series, colour, shaded_ranges};
use crate::study::definition::{Setting, Study, StudyOutcome};

/// Range of grade errors in the figures, %.
const SHOWN_PERCENT: (f64, f64) = (-1.2, 1.2);

/// The study, for the list.
pub const STUDY: Study = Study {
    name: "modified",
    about: "thesis tables 5-8, figures 15-18: original and modified method on the ten runs, and ours",
    run,
};

fn run(setting: &Setting) -> Result<StudyOutcome> {
    let campaign = Campaign::new(setting.seed);
    let runs = campaign.replicas();
    let all = ThesisMethod::ALL.map(|method| method.apply(&runs));
    let [original, modified, _] = &all;
    let mut tables = tables(&runs, &all);
    let compared = summary(original, modified);
    tables.push(compared.table());
    tables.push(made_of(&campaign, &runs));
    let mut words = words();
    words.extend(beside::words(&all));
    words.extend(differences(&compared));
    let mut figures = beside::figures(&all);
    figures.extend(error_figures(&runs, &all));
    Ok(StudyOutcome::Done(Section {
        heading: "Original and modified method, and ours (thesis 8)".to_owned(),
        words,
        tables,
        figures,
        ..Section::default()
    }))
}

/// Returns tables 5-8, and the methods beside each other.
#[must_use]
pub fn tables(runs: &[Replica], all: &[Vec<Estimated>; 3]) -> Vec<Table> {
    let [original, modified, ours] = all;
    let table = |number, method, heading, found| table(number, method, heading, found, ours);
    vec![
        table(5, ThesisMethod::Modified, Heading::South, modified),
        table(6, ThesisMethod::Modified, Heading::North, modified),
        table(7, ThesisMethod::Original, Heading::South, original),
        table(8, ThesisMethod::Original, Heading::North, original),
        beside::each_run(runs, all),
        beside::maps(all),
    ]
}

fn words() -> Vec<String> {
    vec![
        "Predicted, not fitted: σ and all RMSE of tables 5-8, with the noise of the filters as \
         chosen on training runs (the study tuning also shows the results of other choices). µ of \
         the original method follows from the pointwise µ, which is fitted, and from the fraction \
         of it that remains. The noise gives that fraction, and was chosen to give the thesis's. \
         First and last 200 points are left out. RMSE(v) is over points without shifts and \
         braking, RMSE(a) over all, RMSE(m) over all points of the map of this run and those \
         before it, weighted by 1/P."
            .to_owned(),
    ]
}

/// Returns one of tables 5-8: a method of the thesis as replicated and as printed, and ours on the
/// same runs.
fn table(
    number: usize,
    method: ThesisMethod,
    heading: Heading,
    all: &[Estimated],
    ours: &[Estimated],
) -> Table {
    let mut header = vec!["run"];
    for quantity in ["µ %", "σ %", "RMSE(v) %", "RMSE(a) %", "RMSE(m) %"] {
        header.extend([quantity, "thesis", "ours"]);
    }
    let caption = format!(
        "Error of the {}, {} (thesis table {number}): as replicated, as the thesis printed it, \
         and of our estimator on the same drives.",
        method.phrase(),
        heading.word(),
    );
    let rows = all
        .iter()
        .zip(ours)
        .filter(|(found, _)| found.experiment.heading == heading)
        .filter_map(|(found, ours)| {
            let printed = method.of_thesis(found.experiment)?;
            let mut row = vec![found.experiment.number.to_string()];
            for ((replicated, printed), ours) in
                five(found).into_iter().zip(printed).zip(five(ours))
            {
                row.extend([replicated, printed, ours].map(|value| format!("{value:.4}")));
            }
            Some(row)
        });
    Table::new(format!("table{number}"), caption, &header).with_rows(rows)
}

/// Returns µ, σ, RMSE(v), RMSE(a) and RMSE(m).
fn five(found: &Estimated) -> [f64; 5] {
    let RunErrors {
        mu,
        sigma,
        rmse_valid,
        rmse_all,
    } = found.errors;
    [mu, sigma, rmse_valid, rmse_all, found.rmse_merged]
}

fn error_figures(runs: &[Replica], all: &[Vec<Estimated>; 3]) -> Vec<Figure> {
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
        for (method, found) in ThesisMethod::ALL.into_iter().zip(all) {
            let chosen: Vec<(&Replica, &Estimated)> = runs
                .iter()
                .zip(found)
                .filter(|(run, _)| run.experiment.heading == Heading::North)
                .filter(|(run, _)| wanted.contains(&run.experiment.number))
                .collect();
            figures.extend(error_figure(
                &format!("{name}_{}", method.word()),
                &format!("{number}, {}: {what}.", method.phrase()),
                &chosen,
            ));
        }
    }
    figures
}

/// Plots the error over distance of the map of some runs, or of a single run. Braking in any of
/// them is shaded; gear shifts in any of them are marked on the axis.
fn error_figure(name: &str, caption: &str, runs: &[(&Replica, &Estimated)]) -> Option<Figure> {
    let (first, _) = runs.first()?;
    let profiles: Vec<&Profile> = runs.iter().map(|(_, found)| &found.profile).collect();
    let grade = merged(&profiles);
    let km = |k: usize| k as f64 * STEP_M * 1e-3;
    let any = |k: usize, of: fn(&MeasuredPoint) -> bool| {
        runs.iter().any(|(run, _)| of(&run.drive.points[k]))
    };
    let error = inner(first).map(|k| (km(k), grade[k] - first.truth[k]));
    let mut plot =
        Plot::new("distance (km)", "grade error (%)").with(Series::line("", colour::BLUE, error));
    plot.shaded = shaded_ranges(inner(first).map(|k| (km(k), any(k, |point| point.braking))));
    plot.ticks = inner(first)
        .filter(|&k| any(k, |point| point.shifting) && !any(k - 1, |point| point.shifting))
        .map(km)
        .collect();
    plot.y_range = Some(SHOWN_PERCENT);
    plot.height = 240;
    let error = rmse(&first.truth, &grade);
    let mut caption = format!("{caption} RMSE {error:.3} %.");
    if !plot.shaded.is_empty() {
        caption += " Grey: braking.";
    }
    if !plot.ticks.is_empty() {
        caption += " Marks on the axis: gear shifts.";
    }
    Some(Figure::new(name, &plot, caption))
}
