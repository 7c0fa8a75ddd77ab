//! Our estimator against the modified method over several campaigns, to exclude chance.

use super::beside::{LARGEST_MAP_RMSE_PERCENT, judged_maps};
use super::campaign::Campaign;
use super::experiment::Experiment;
use super::method::{Estimated, ThesisMethod};
use crate::error::Result;
use crate::numeric::statistics::mean;
use crate::report::page::{Section, Table};
use crate::study::definition::{Setting, Study, StudyOutcome};
use rayon::prelude::*;

/// Number of campaigns.
const CAMPAIGNS: u64 = 10;
/// Difference between the seeds of two campaigns. A campaign's roads take two seeds.
const APART: u64 = 10;

/// The study, for the list.
pub const STUDY: Study = Study {
    name: "campaigns",
    about: "the ten runs ten times over, on other roads with other errors: ours and the modified method",
    run,
};

fn run(setting: &Setting) -> Result<StudyOutcome> {
    let all = estimated(setting.seed, Campaign::new);
    Ok(StudyOutcome::Done(Section {
        heading: "The ten runs over ten campaigns".to_owned(),
        words: vec![format!(
            "One campaign is one draw of roads, GPS errors and wind. {}",
            words(&all)
        )],
        tables: tables(&all),
        ..Section::default()
    }))
}

/// Returns the ten runs of each campaign, estimated by each method. `campaign` makes the campaign of
/// a seed.
#[must_use]
pub fn estimated(seed: u64, campaign: impl Fn(u64) -> Campaign + Sync) -> Vec<[Vec<Estimated>; 3]> {
    (1..=CAMPAIGNS)
        .into_par_iter()
        .map(|number| {
            let runs = campaign(seed.wrapping_add(APART * number)).replicas();
            ThesisMethod::ALL.map(|method| method.apply(&runs))
        })
        .collect()
}

/// Returns the tables of runs and of maps over campaigns.
#[must_use]
pub fn tables(all: &[[Vec<Estimated>; 3]]) -> Vec<Table> {
    vec![runs_table(all), maps_table(all)]
}

/// Returns in how many runs ours is better, in words.
#[must_use]
pub fn words(all: &[[Vec<Estimated>; 3]]) -> String {
    let experiments = Experiment::all().len();
    let each = || (0..experiments).map(|k| pairs(all, k));
    let runs = all.len() * experiments;
    let better: usize = each().map(|pairs| count_better(&pairs)).sum();
    let better_on_average = each()
        .filter(|pairs| {
            let sum = |of: fn(&(&Estimated, &Estimated)) -> f64| pairs.iter().map(of).sum::<f64>();
            sum(|pair| pair.1.errors.rmse_valid) < sum(|pair| pair.0.errors.rmse_valid)
        })
        .count();
    format!(
        "Over {CAMPAIGNS} of them our estimator is better than the modified method in {better} of {runs} \
         runs (RMSE(v)), and in the mean over campaigns in {better_on_average} of the {experiments} \
         experiments."
    )
}

/// Returns the estimates of one run in each campaign, by the modified method and by ours.
fn pairs(all: &[[Vec<Estimated>; 3]], run: usize) -> Vec<(&Estimated, &Estimated)> {
    all.iter()
        .map(|[_, modified, ours]| (&modified[run], &ours[run]))
        .collect()
}

fn ratio((modified, ours): &(&Estimated, &Estimated)) -> f64 {
    ours.errors.rmse_valid / modified.errors.rmse_valid
}

fn count_better(pairs: &[(&Estimated, &Estimated)]) -> usize {
    pairs.iter().filter(|pair| ratio(pair) < 1.0).count()
}

fn runs_table(all: &[[Vec<Estimated>; 3]]) -> Table {
    let header = [
        "run",
        "modified %",
        "ours %",
        "ours over modified: least",
        "median",
        "largest",
        "better in",
        "NEES modified",
        "NEES ours",
    ];
    let caption = format!(
        "RMSE(v) over {CAMPAIGNS} campaigns: means, ours against the modified method run by run, \
         and mean normalised squared errors."
    );
    let rows = Experiment::all()
        .into_iter()
        .enumerate()
        .map(|(k, experiment)| {
            let pairs = pairs(all, k);
            let mean_of = |value: &dyn Fn(&(&Estimated, &Estimated)) -> f64| {
                mean(&pairs.iter().map(value).collect::<Vec<f64>>())
            };
            let [least, median, largest] = spread(pairs.iter().map(ratio).collect());
            vec![
                experiment.name(),
                format!("{:.4}", mean_of(&|pair| pair.0.errors.rmse_valid)),
                format!("{:.4}", mean_of(&|pair| pair.1.errors.rmse_valid)),
                format!("{least:.2}"),
                format!("{median:.2}"),
                format!("{largest:.2}"),
                count_better(&pairs).to_string(),
                format!("{:.2}", mean_of(&|pair| pair.0.nees)),
                format!("{:.2}", mean_of(&|pair| pair.1.nees)),
            ]
        });
    Table::new("campaigns", caption, &header).with_rows(rows)
}

fn maps_table(all: &[[Vec<Estimated>; 3]]) -> Table {
    let header = [
        "map",
        "modified %",
        "ours %",
        "ours least %",
        "median %",
        "largest %",
        "within",
    ];
    let caption = format!(
        "RMSE(m) of maps over {CAMPAIGNS} campaigns: means, the spread of ours, and in how many \
         campaigns it is at most {LARGEST_MAP_RMSE_PERCENT} %."
    );
    let maps: Vec<_> = all.iter().map(judged_maps).collect();
    let count = maps.first().map_or(0, Vec::len);
    let rows = (0..count).map(|map| {
        let of = |method: usize| -> Vec<f64> { maps.iter().map(|m| m[map].rmse[method]).collect() };
        let ours = of(2);
        let within = ours
            .iter()
            .filter(|rmse| **rmse <= LARGEST_MAP_RMSE_PERCENT)
            .count();
        let mut row = vec![maps[0][map].name()];
        let numbers = [mean(&of(1)), mean(&ours)].into_iter().chain(spread(ours));
        row.extend(numbers.map(|rmse| format!("{rmse:.4}")));
        row.push(within.to_string());
        row
    });
    Table::new("campaigns_maps", caption, &header).with_rows(rows)
}

/// Returns the minimum, median and maximum.
fn spread(mut values: Vec<f64>) -> [f64; 3] {
    values.sort_by(f64::total_cmp);
    let middle = values.len() / 2;
    let median = if values.len().is_multiple_of(2) {
        0.5 * (values[middle - 1] + values[middle])
    } else {
        values[middle]
    };
    [values[0], median, values[values.len() - 1]]
}
