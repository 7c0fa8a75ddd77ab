//! Our estimator against the thesis's methods: run by run, and on maps.

use super::experiment::Experiment;
use super::heading::Heading;
use super::measure::errors;
use super::method::{Estimated, ThesisMethod};
use super::ours;
use super::replica::Replica;
use crate::report::page::{Figure, Table};
use crate::report::plot::{Mark, Plot, Series, colour};
use rayon::prelude::*;

/// Largest RMSE of the map of truck A's three runs, and of the map of all five runs, in each
/// direction, %. It is a little below the error of the thesis's reference (section 3.1).
pub const LARGEST_MAP_RMSE_PERCENT: f64 = 0.045;
/// Numbers of runs in the judged maps: the runs of A, and all runs.
const RUNS_OF_MAPS: [usize; 2] = [3, 5];

/// The three methods on one map.
#[derive(Clone, Copy, Debug)]
pub struct Map {
    /// Direction of travel.
    pub heading: Heading,
    /// Number of runs in the map.
    pub runs: usize,
    /// RMSE(m) in the order of [`ThesisMethod::ALL`], %.
    pub rmse: [f64; 3],
}

impl Map {
    /// Returns the name of the map: its runs and direction.
    #[must_use]
    pub fn name(&self) -> String {
        format!("{} runs {}", self.runs, self.heading.word())
    }
}

impl Experiment {
    /// Returns the direction and the number.
    #[must_use]
    pub fn name(self) -> String {
        format!("{} {}", self.heading.word(), self.number)
    }
}

/// Returns the runs in which ours is not better than the modified method, by RMSE(v).
#[must_use]
pub fn not_better([_, modified, ours]: &[Vec<Estimated>; 3]) -> Vec<Experiment> {
    modified
        .iter()
        .zip(ours)
        .filter(|(modified, ours)| ours.errors.rmse_valid >= modified.errors.rmse_valid)
        .map(|(_, ours)| ours.experiment)
        .collect()
}

/// Returns the maps that are judged.
#[must_use]
pub fn judged_maps(all: &[Vec<Estimated>; 3]) -> Vec<Map> {
    let last_of = |heading, runs| {
        all[0].iter().position(|found| {
            (found.experiment.heading, found.experiment.number) == (heading, runs)
        })
    };
    let pairs = Heading::BOTH.map(|heading| RUNS_OF_MAPS.map(|runs| (heading, runs)));
    pairs
        .into_iter()
        .flatten()
        .filter_map(|(heading, runs)| {
            let last = last_of(heading, runs)?;
            Some(Map {
                heading,
                runs,
                rmse: [0, 1, 2].map(|method: usize| all[method][last].rmse_merged),
            })
        })
        .collect()
}

/// Returns the summary of the tables in words.
#[must_use]
pub fn words(all: &[Vec<Estimated>; 3]) -> Vec<String> {
    let runs = all[0].len();
    let worse = not_better(all);
    let listed = |names: Vec<String>| names.join(", ");
    let verdict = if worse.is_empty() {
        format!("It is better than the modified method in each of the {runs} runs (RMSE(v)).")
    } else {
        format!(
            "It is better than the modified method in {} of the {runs} runs (RMSE(v)), but not in \
             {}.",
            runs - worse.len(),
            listed(worse.into_iter().map(Experiment::name).collect())
        )
    };
    let maps = judged_maps(all);
    let (good, bad): (Vec<&Map>, Vec<&Map>) = maps
        .iter()
        .partition(|map| map.rmse[2] <= LARGEST_MAP_RMSE_PERCENT);
    let name = |map: &&Map| {
        format!(
            "{} runs {} {:.3} %",
            map.runs,
            map.heading.word(),
            map.rmse[2]
        )
    };
    let mut of_maps = format!(
        "Of its maps of three runs (truck A) and of all five in each direction, {} of {} have an \
         RMSE of at most {LARGEST_MAP_RMSE_PERCENT} %",
        good.len(),
        maps.len(),
    );
    if !bad.is_empty() {
        of_maps.push_str("; the others: ");
        of_maps.push_str(&listed(bad.iter().map(name).collect()));
    }
    of_maps.push('.');
    vec![
        "Our estimator runs on the same drives. It is the vehicle's own filter in single \
         precision, with the same false parameters, the force and speed of each point, and the \
         altitude once a second, as a receiver reports it. Its tuning is the vehicle's default; \
         nothing is set for this study. Its columns in tables 5-8 are smoothed over the whole \
         run, as the thesis's methods are."
            .to_owned(),
        format!("{verdict} {of_maps}"),
    ]
}

/// Returns the table of the methods run by run.
#[must_use]
pub fn each_run(runs: &[Replica], all: &[Vec<Estimated>; 3]) -> Table {
    let [original, modified, ours] = all;
    let header = [
        "run",
        "original %",
        "modified %",
        "ours %",
        "ours over modified",
        "ours lagged %",
        "ours live %",
        "NEES modified",
        "NEES ours",
    ];
    let caption = "RMSE(v) of the three methods on the same drives; ours also lagged by 500 m and \
                   live, as on the vehicle. NEES is the mean normalised squared error: 1 if the \
                   stated sigmas are consistent, less if they are too wide.";
    let mut table = Table::new("beside", caption, &header);
    table.rows = runs
        .par_iter()
        .enumerate()
        .map(|(k, run)| {
            let on_vehicle = ours::estimate(&run.drive);
            let [lagged, live] = [on_vehicle.lagged, on_vehicle.live]
                .map(|profile| errors(run, &profile.grade_percent).rmse_valid);
            let [original, modified, ours] = [original, modified, ours].map(|found| &found[k]);
            let rmse = |found: &Estimated| found.errors.rmse_valid;
            vec![
                run.experiment.name(),
                format!("{:.4}", rmse(original)),
                format!("{:.4}", rmse(modified)),
                format!("{:.4}", rmse(ours)),
                format!("{:.2}", rmse(ours) / rmse(modified)),
                format!("{lagged:.4}"),
                format!("{live:.4}"),
                format!("{:.2}", modified.nees),
                format!("{:.2}", ours.nees),
            ]
        })
        .collect();
    table
}

/// Returns the table of the methods on the judged maps.
#[must_use]
pub fn maps(all: &[Vec<Estimated>; 3]) -> Table {
    let header = [
        "map",
        "original %",
        "modified %",
        "ours %",
        "at most %",
        "ours within",
    ];
    let caption = "RMSE(m) of maps: the three runs of truck A, and all five, in each direction.";
    let rows = judged_maps(all).into_iter().map(|map| {
        let mut row = vec![map.name()];
        row.extend(map.rmse.map(|rmse| format!("{rmse:.4}")));
        let within = map.rmse[2] <= LARGEST_MAP_RMSE_PERCENT;
        row.push(format!("{LARGEST_MAP_RMSE_PERCENT:.3}"));
        row.push(if within { "yes" } else { "no" }.to_owned());
        row
    });
    Table::new("maps", caption, &header).with_rows(rows)
}

/// Returns the RMSE of maps over the number of runs, one figure a direction.
#[must_use]
pub fn figures(all: &[Vec<Estimated>; 3]) -> Vec<Figure> {
    Heading::BOTH
        .into_iter()
        .map(|heading| {
            let mut plot = Plot::new("runs in the map", "RMSE(m) (%)");
            let colours = [colour::GREY, colour::ORANGE, colour::BLUE];
            for ((method, found), colour) in ThesisMethod::ALL.into_iter().zip(all).zip(colours) {
                let members = found.iter().filter(|f| f.experiment.heading == heading);
                let points = members.map(|f| (f.experiment.number as f64, f.rmse_merged));
                plot = plot.with(Series::line(method.phrase(), colour, points));
            }
            let within = [1.0, 5.0].map(|runs| (runs, LARGEST_MAP_RMSE_PERCENT));
            let name = format!("{LARGEST_MAP_RMSE_PERCENT} %");
            let line = Series::line(name, colour::BLACK, within).drawn(Mark::Dashed);
            let caption = format!(
                "Error of the {} map against the number of runs: 1 to 3 by truck A, 4 and 5 by \
                 truck B.",
                heading.word()
            );
            Figure::new(
                format!("maps_{}", heading.word()),
                &plot.with(line),
                caption,
            )
        })
        .collect()
}
