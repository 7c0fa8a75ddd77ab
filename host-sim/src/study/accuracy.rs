//! Accuracy of the estimator on simulated drives with wrong parameters, wind and cold tyres; and
//! the error as a function of the lag.

use super::definition::{Setting, Study, StudyOutcome};
use super::drive_errors::{DriveErrors, DriveOnRoad, WORDS, mean_of};
use crate::error::Result;
use crate::report::page::{Figure, Section, Table};
use crate::report::plot::{Plot, Series, colour};
use crate::score::END_CUT_M;
use crate::simulator::truck::Preset;
use crate::terminal::progress;
use estimator_core::CELL_LENGTH_M;
use estimator_core::smoother::fixed_lag::{BLOCK_CELLS, LAG_CELLS, bytes};
use rayon::prelude::*;

/// The study, for the list.
pub const STUDY: Study = Study {
    name: "accuracy",
    about: "errors with wrong parameters, wind and cold tyres; error against lag and memory",
    run,
};

/// Roads for each truck and receiver. Each road is driven in both directions.
const ROADS: u64 = 10;
/// Sizes of the receiver's slow altitude error, 1 sigma, m.
const RECEIVERS_M: [f64; 3] = [1.0, 2.0, 3.0];
/// The receiver of the lag's curve.
const RECEIVER_OF_CURVE_M: f64 = 2.0;
/// Lags of the curve, in blocks of cells.
const LAG_BLOCKS: [usize; 8] = [0, 1, 2, 4, 6, 10, 14, 20];

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
                    let lags: &[usize] = if receiver_m == RECEIVER_OF_CURVE_M {
                        &LAG_BLOCKS
                    } else {
                        &[LAG_CELLS / BLOCK_CELLS]
                    };
                    let drive =
                        DriveOnRoad::new(setting.seed + i / 2, truck, i % 2 == 1, receiver_m)?;
                    let errors = drive.errors(&[], lags).expect("no signal is missing");
                    bar.inc(1);
                    Ok(errors)
                })
                .collect::<Result<Vec<_>>>()
        })
        .collect::<Result<_>>()?;
    bar.finish_and_clear();
    let of_curve = |truck| {
        let at = groups
            .iter()
            .position(|group| *group == (truck, RECEIVER_OF_CURVE_M));
        at.map(|at| drives[at].as_slice()).unwrap_or_default()
    };
    let curves = [Preset::A, Preset::B].map(|truck| (truck, of_curve(truck)));
    Ok(StudyOutcome::Done(Section {
        heading: "Accuracy with wrong parameters, wind and cold tyres".to_owned(),
        words: vec![format!(
            "{} drives of 40 km for each line. {WORDS} The first and last {END_CUT_M:.0} m are \
             left out. The slow error of the receiver's altitude has a correlation time of about \
             250 s. The estimator is not given its size but estimates it. The limit of the \
             grade's accuracy is how well GNSS determines the model's slow error.",
            2 * ROADS
        )],
        tables: vec![accuracy(&groups, &drives), lag_table(&curves)],
        figures: vec![lag_figure(&curves)],
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
        let lagged = |drive: &DriveErrors| drive.lagged[lag_place(drive)];
        let each = |errors: &dyn Fn(&DriveErrors) -> f64| mean_of(drives, errors);
        table.rows.push(vec![
            truck.name().to_owned(),
            format!("{receiver_m:.0}"),
            format!("{:.4}", each(&|d| d.smoothed.rmse())),
            format!("{:.4}", each(&|d| lagged(d).rmse())),
            format!("{:.4}", each(&|d| d.live.rmse())),
            format!("{:.2}", each(&|d| d.smoothed.nees())),
            format!("{:.2}", each(&|d| lagged(d).nees())),
            format!("{:.2}", each(&|d| d.live.nees())),
            format!("{:.3}", one_sigma(drives.iter().map(|d| d.scale.0.abs()))),
            format!("{:.3}", each(&|d| d.scale.1)),
        ]);
    }
    table
}

/// Returns the index of the core's own lag in [`DriveErrors::lagged`].
fn lag_place(drive: &DriveErrors) -> usize {
    if drive.lagged.len() == 1 {
        0
    } else {
        let own = LAG_CELLS / BLOCK_CELLS;
        LAG_BLOCKS
            .iter()
            .position(|blocks| *blocks == own)
            .unwrap_or_default()
    }
}

fn lag_m(blocks: usize) -> f64 {
    (blocks * BLOCK_CELLS) as f64 * f64::from(CELL_LENGTH_M)
}

fn lag_rmse(drives: &[DriveErrors], i: usize) -> f64 {
    mean_of(drives, |drive| drive.lagged[i].rmse())
}

fn lag_table(curves: &[(Preset, &[DriveErrors]); 2]) -> Table {
    let mut table = Table::new(
        "lag",
        format!(
            "RMSE of the lagged grade (%) against the shortest distance driven after a cell (GNSS \
             slow error {RECEIVER_OF_CURVE_M:.0} m), and the memory of the lag in single \
             precision. The core has {:.0} m.",
            lag_m(LAG_CELLS / BLOCK_CELLS)
        ),
        &["lag m", "memory kB", "truck A %", "truck B %"],
    );
    for (i, blocks) in LAG_BLOCKS.into_iter().enumerate() {
        let mut row = vec![
            format!("{:.0}", lag_m(blocks)),
            format!("{:.1}", bytes::<f32>(blocks) as f64 / 1_000.0),
        ];
        row.extend(curves.map(|(_, drives)| format!("{:.4}", lag_rmse(drives, i))));
        table.rows.push(row);
    }
    table
}

fn lag_figure(curves: &[(Preset, &[DriveErrors]); 2]) -> Figure {
    let mut plot = Plot::new("lag (m)", "RMSE of the lagged grade (%)");
    for ((truck, drives), colour) in curves.iter().zip([colour::BLUE, colour::ORANGE]) {
        let points = LAG_BLOCKS
            .into_iter()
            .enumerate()
            .map(|(i, blocks)| (lag_m(blocks), lag_rmse(drives, i)));
        plot = plot.with(Series::line(
            format!("truck {}", truck.name()),
            colour,
            points,
        ));
    }
    Figure::new(
        "lag_curve",
        &plot,
        "The first 50 m remove the errors of short waves. A longer lag improves only the estimate \
         of the model's slow error.",
    )
}
