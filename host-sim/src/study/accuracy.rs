//! How accurate the estimator is on simulated drives with wrong parameters, wind and cold tyres; and
//! what a longer lag would buy.

use super::definition::{Outcome, Setting, Study};
use crate::error::Result;
use crate::numeric::series::linear;
use crate::report::page::{Figure, Section, Table};
use crate::report::plot::{Plot, Series, colour};
use crate::score::END_CUT_M;
use crate::simulator::scenario::Scenario;
use crate::simulator::simulate;
use crate::simulator::truck::Preset;
use crate::smooth::{FilteredCell, smooth_run};
use crate::terminal::progress;
use estimator_core::filter::{Filter, SensorNoiseRatios};
use estimator_core::smoother::BackwardPass;
use estimator_core::smoother::fixed_lag::{BLOCK_CELLS, LAG_CELLS, bytes};
use estimator_core::{CELL_LENGTH_M, Context, Estimator, Tuning, Uncertain};
use rayon::prelude::*;
use std::path::Path;

/// The study, for the list.
pub const STUDY: Study = Study {
    name: "accuracy",
    about: "errors with wrong parameters, wind and cold tyres; error against lag and memory",
    run,
};

/// Roads for each truck and receiver; each is driven in both directions.
const ROADS: u64 = 10;
/// Sizes of the receiver's slow altitude error, 1 sigma, m.
const RECEIVERS_M: [f64; 3] = [1.0, 2.0, 3.0];
/// The receiver of the lag's curve.
const RECEIVER_OF_CURVE_M: f64 = 2.0;
/// Lags of the curve, in blocks of cells.
const LAG_BLOCKS: [usize; 8] = [0, 1, 2, 4, 6, 10, 14, 20];
/// Where the scale is judged, m.
const SCALE_AT_M: f64 = 20_000.0;

/// Errors of one kind of estimate on one drive.
#[derive(Clone, Copy, Debug, Default)]
struct Errors {
    cells: f64,
    squared: f64,
    normalised: f64,
}

/// One drive.
struct Drive {
    smoothed: Errors,
    live: Errors,
    /// For each of [`LAG_BLOCKS`].
    lagged: Vec<Errors>,
    /// Found less true scale, and its sigma, at [`SCALE_AT_M`].
    scale: (f64, f64),
}

impl Errors {
    fn add(&mut self, found: Uncertain, true_percent: f64) {
        let error = f64::from(found.value) - true_percent;
        self.cells += 1.0;
        self.squared += error * error;
        self.normalised += (error / f64::from(found.sigma)).powi(2);
    }

    fn rmse(&self) -> f64 {
        (self.squared / self.cells).sqrt()
    }

    fn nees(&self) -> f64 {
        self.normalised / self.cells
    }
}

/// 40 km; mass, drag and rolling resistance wrong by 10 % (1 sigma), torque by 4 %.
fn scenario(seed: u64, truck: Preset, backward: bool, receiver_m: f64) -> String {
    let direction = if backward { "backward" } else { "forward" };
    format!(
        "seed = {seed}
         [errors]
         mass_sigma = 0.1
         drag_sigma = 0.1
         rolling_sigma = 0.1
         torque_sigma = 0.04
         [tyres]
         cold_amount = 0.3
         [wind]
         speed_mps = 2.0
         from_deg = 250.0
         gust_sigma_mps = 0.3
         gust_time_s = 120.0
         [gnss]
         altitude_sigma_m = {receiver_m}
         [[runs]]
         name = \"x\"
         truck = \"{}\"
         direction = \"{direction}\"",
        truck.name()
    )
}

fn drive(text: &str, lags: &[usize]) -> Result<Drive> {
    let scenario = Scenario::parse(text, Path::new("accuracy"))?;
    let run = simulate(&scenario, 0)?;
    let tuning = Tuning::default();
    let mut estimator = Estimator::<f32>::new(run.vehicle.model.clone(), tuning.clone())
        .expect("the simulator checked the vehicle");
    let mut samples = Vec::new();
    for frame in &run.frames {
        estimator.on_frame(frame.time, &frame.frame);
        while estimator.step().is_some() {
            samples.extend(estimator.sample().copied());
            while estimator.next_cell().is_some() {}
        }
    }
    let smoothed = smooth_run(
        estimator.model(),
        &tuning,
        &estimator.second_pass_filter::<f64>(),
        &samples,
    );
    let mut filter = Filter::<f32>::new(&tuning, &SensorNoiseRatios::default(), None);
    let mut context =
        Context::new(estimator.model().clone(), tuning).expect("the estimator checked the vehicle");
    let cells: Vec<FilteredCell<f32>> = samples
        .iter()
        .filter_map(|sample| FilteredCell::step(&mut filter, &mut context, sample))
        .collect();

    let truth: Vec<(f64, f64)> = run
        .truth
        .iter()
        .map(|t| (t.time_s, t.grade_percent))
        .collect();
    let start = run.frames[0].time;
    let ends_m = cells[0].record.end.distance_m() + END_CUT_M
        ..cells[cells.len() - 1].record.end.distance_m() - END_CUT_M;
    let judged: Vec<Option<f64>> = cells
        .iter()
        .map(|cell| {
            let end = &cell.record.end;
            let time_s = end.time.since(start).micros() as f64 * 1e-6;
            linear(&truth, time_s).filter(|_| ends_m.contains(&end.distance_m()))
        })
        .collect();

    let mut errors = Drive {
        smoothed: Errors::default(),
        live: Errors::default(),
        lagged: vec![Errors::default(); lags.len()],
        scale: scale_error(&cells, scenario.runs[0].true_scale()),
    };
    for (k, true_percent) in judged.iter().enumerate() {
        if let Some(true_percent) = true_percent {
            errors
                .smoothed
                .add(smoothed[k].estimate.grade_percent, *true_percent);
            errors
                .live
                .add(cells[k].state.estimate().grade_percent, *true_percent);
        }
    }
    for (lag, errors) in lags.iter().zip(&mut errors.lagged) {
        // As the core finishes cells: a block at a time.
        for from in (0..cells.len()).step_by(BLOCK_CELLS) {
            let block = from..(from + BLOCK_CELLS).min(cells.len());
            let to = (block.end + lag * BLOCK_CELLS).min(cells.len());
            let mut pass = BackwardPass::new();
            for k in (from..to).rev() {
                if let Some(true_percent) = judged[k].filter(|_| block.contains(&k)) {
                    errors.add(pass.estimate(&cells[k].state).grade_percent, true_percent);
                }
                pass.retreat(&cells[k].record.smoother_input);
            }
        }
    }
    Ok(errors)
}

fn scale_error(cells: &[FilteredCell<f32>], true_scale: f64) -> (f64, f64) {
    let at = cells.partition_point(|cell| cell.record.end.distance_m() < SCALE_AT_M);
    let scale = cells[at.min(cells.len() - 1)].state.estimate().scale;
    (f64::from(scale.value) - true_scale, f64::from(scale.sigma))
}

fn run(setting: &Setting) -> Result<Outcome> {
    let groups: Vec<(Preset, f64)> = [Preset::A, Preset::B]
        .into_iter()
        .flat_map(|truck| RECEIVERS_M.map(|receiver_m| (truck, receiver_m)))
        .collect();
    let bar = progress::count(groups.len() as u64 * 2 * ROADS, "drives");
    let drives: Vec<Vec<Drive>> = groups
        .iter()
        .map(|&(truck, receiver_m)| {
            (0..2 * ROADS)
                .into_par_iter()
                .map(|i| {
                    let text = scenario(setting.seed + i / 2, truck, i % 2 == 1, receiver_m);
                    let lags: &[usize] = if receiver_m == RECEIVER_OF_CURVE_M {
                        &LAG_BLOCKS
                    } else {
                        &[LAG_CELLS / BLOCK_CELLS]
                    };
                    let drive = drive(&text, lags);
                    bar.inc(1);
                    drive
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
    Ok(Outcome::Done(Section {
        heading: "Accuracy with wrong parameters, wind and cold tyres".to_owned(),
        words: vec![format!(
            "{} drives of 40 km for each line: mass, drag and rolling resistance wrong by 10 % \
             (1 sigma), torque by 4 %, tyres that begin with 30 % more resistance, a wind of 2 m/s \
             with slow gusts of 0.3. The first and last {END_CUT_M:.0} m are left out. The slow \
             error of the receiver's altitude keeps its value for some 250 s; its size is not told \
             to the estimator, which learns it. What limits the grade here is what GNSS can tell of \
             the model's slow error.",
            2 * ROADS
        )],
        tables: vec![accuracy(&groups, &drives), lag_table(&curves)],
        figures: vec![lag_figure(&curves)],
    }))
}

fn mean(values: impl Iterator<Item = f64>) -> f64 {
    let (sum, count) = values.fold((0.0, 0.0), |(sum, n), value| (sum + value, n + 1.0));
    sum / f64::max(count, 1.0)
}

/// What 68.3 % of the values stay within.
fn one_sigma(values: impl Iterator<Item = f64>) -> f64 {
    let mut values: Vec<f64> = values.collect();
    values.sort_by(f64::total_cmp);
    let place = (0.683 * values.len() as f64).ceil() as usize;
    values
        .get(place.saturating_sub(1))
        .copied()
        .unwrap_or(f64::NAN)
}

fn accuracy(groups: &[(Preset, f64)], drives: &[Vec<Drive>]) -> Table {
    let mut table = Table::new(
        "accuracy",
        "Mean RMSE of grade over drives (%), mean normalised squared errors (NEES, 1 if the stated \
         sigmas are honest), and the error of the traction scale after 20 km: what 68 % of the drives stay \
         within, and the mean of what the filter said of it.",
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
        let lagged = |drive: &Drive| drive.lagged[lag_place(drive)];
        let each = |errors: &dyn Fn(&Drive) -> f64| mean(drives.iter().map(errors));
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

/// Where the core's own lag stands among those of a drive.
fn lag_place(drive: &Drive) -> usize {
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

fn lag_rmse(drives: &[Drive], i: usize) -> f64 {
    mean(drives.iter().map(|drive| drive.lagged[i].rmse()))
}

fn lag_table(curves: &[(Preset, &[Drive]); 2]) -> Table {
    let mut table = Table::new(
        "lag",
        format!(
            "RMSE of the lagged grade (%) against how far ahead a cell has been seen at the least \
             (GNSS slow error {RECEIVER_OF_CURVE_M:.0} m), and the memory that the lag takes in \
             single precision. The core has {:.0} m.",
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

fn lag_figure(curves: &[(Preset, &[Drive]); 2]) -> Figure {
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
        "lag",
        &plot,
        "The first 50 m settle the short waves; from there on a longer lag only helps to tell the \
         model's slow error.",
    )
}
