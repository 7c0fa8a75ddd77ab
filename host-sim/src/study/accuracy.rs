//! Accuracy of the estimator on simulated drives with wrong parameters, wind and cold tyres.

use super::definition::{Setting, Study, StudyOutcome};
use super::drive_errors::{DriveErrors, DriveOnRoad, WORDS, mean_of};
use crate::error::Result;
use crate::report::page::{Section, Table};
use crate::score::END_CUT_M;
use crate::simulator::truck::Preset;
use crate::terminal::progress;
use rayon::prelude::*;

/// The study, for the list.
pub const STUDY: Study = Study {
    name: "accuracy",
    about: "errors with wrong parameters, wind and cold tyres",
    run,
};

/// Roads for each truck and receiver. Each road is driven in both directions.
const ROADS: u64 = 10;
/// Sizes of the receiver's slow altitude error, 1 sigma, m.
const RECEIVERS_M: [f64; 3] = [1.0, 2.0, 3.0];

fn run(setting: &Setting) -> Result<StudyOutcome> {
    let groups: Vec<(Preset, f64)> = [Preset::A, Preset::B]
        .into_iter()
        .flat_map(|truck| RECEIVERS_M.map(|receiver_m| (truck, receiver_m)))
        .collect();
    let bar = progress::count(groups.len() as u64 * 2 * ROADS, "drives");
    let drives: Vec<Vec<DriveErrors>> = groups
        .iter()
        .map(|&(truck, receiver_m)| {
            (0..2 * ROADS)
                .into_par_iter()
                .map(|i| {
                    let drive =
                        DriveOnRoad::new(setting.seed + i / 2, truck, i % 2 == 1, receiver_m)?;
                    let errors = drive.errors(&[]).expect("no signal is missing");
                    bar.inc(1);
                    Ok(errors)
                })
                .collect::<Result<Vec<_>>>()
        })
        .collect::<Result<_>>()?;
    bar.finish_and_clear();
    Ok(StudyOutcome::Done(Section {
        heading: "Accuracy with wrong parameters, wind and cold tyres".to_owned(),
        words: vec![format!(
            "{} drives of 40 km for each line. {WORDS} The first and last {END_CUT_M:.0} m are \
             left out. The slow error of the receiver's altitude has a correlation time of about \
             250 s. The estimator is not given its size but estimates it. The limit of the \
             grade's accuracy is how well GNSS determines the model's slow error.",
            2 * ROADS
        )],
        tables: vec![accuracy(&groups, &drives)],
        ..Section::default()
    }))
}

/// Returns the 68.3 % quantile of the values.
fn one_sigma(values: impl Iterator<Item = f64>) -> f64 {
    let mut values: Vec<f64> = values.collect();
    values.sort_by(f64::total_cmp);
    let place = (0.683 * values.len() as f64).ceil() as usize;
    values
        .get(place.saturating_sub(1))
        .copied()
        .unwrap_or(f64::NAN)
}

fn accuracy(groups: &[(Preset, f64)], drives: &[Vec<DriveErrors>]) -> Table {
    let mut table = Table::new(
        "accuracy",
        "Mean RMSE of grade over drives (%), mean normalised squared errors (NEES, 1 if the \
         stated sigmas are consistent), and the error of the traction scale after 20 km: its 68 % \
         quantile over the drives, and the mean of the filter's sigma.",
        &[
            "truck",
            "GNSS slow error m",
            "smoothed %",
            "lagged %",
            "live %",
            "NEES smoothed",
            "NEES lagged",
            "NEES live",
            "scale error",
            "scale sigma",
        ],
    );
    for ((truck, receiver_m), drives) in groups.iter().zip(drives) {
        let each = |errors: &dyn Fn(&DriveErrors) -> f64| mean_of(drives, errors);
        table.rows.push(vec![
            truck.name().to_owned(),
            format!("{receiver_m:.0}"),
            format!("{:.4}", each(&|d| d.smoothed.rmse())),
            format!("{:.4}", each(&|d| d.lagged.rmse())),
            format!("{:.4}", each(&|d| d.live.rmse())),
            format!("{:.2}", each(&|d| d.smoothed.nees())),
            format!("{:.2}", each(&|d| d.lagged.nees())),
            format!("{:.2}", each(&|d| d.live.nees())),
            format!("{:.3}", one_sigma(drives.iter().map(|d| d.scale.0.abs()))),
            format!("{:.3}", each(&|d| d.scale.1)),
        ]);
    }
    table
}
