//! Errors of the estimator on simulated drives whose parameters are wrong.

use crate::error::Result;
use crate::numeric::series::linear;
use crate::numeric::statistics::mean;
use crate::score::END_CUT_M;
use crate::simulator::scenario::Scenario;
use crate::simulator::truck::Preset;
use crate::simulator::{SimulatedRun, simulate};
use crate::smooth::{Known, smooth_run};
use estimator_core::estimator::CellEstimator;
use estimator_core::signal::{Decoder, Signal};
use estimator_core::{Cell, CellEnd, Context, Estimator, Sample, Step, Tuning, Uncertain};
use std::iter::from_fn;
use std::ops::Range;
use std::path::Path;

/// The assumptions of the drives, in words for the page.
pub const WORDS: &str = "Mass, drag and rolling resistance are wrong by 10 % (1 sigma), torque by \
                         4 %. Tyres begin with 30 % more resistance; a wind of 2 m/s has slow \
                         gusts of 0.3.";

/// Distance at which the traction scale is judged, m.
pub const SCALE_AT_M: f64 = 20_000.0;

/// One simulated drive of 40 km.
pub struct DriveOnRoad {
    run: SimulatedRun,
    true_scale: f64,
}

/// Errors of one kind of estimate on one drive.
#[derive(Clone, Copy, Debug, Default)]
pub struct ErrorSums {
    cells: f64,
    squared: f64,
    normalised: f64,
}

/// Errors of all estimates on one drive.
pub struct DriveErrors {
    /// Errors of the grade smoothed over the whole drive.
    pub smoothed: ErrorSums,
    /// Errors of the live grade.
    pub live: ErrorSums,
    /// Errors of the lagged grade.
    pub lagged: ErrorSums,
    /// Estimated minus true traction scale, and its sigma, at [`SCALE_AT_M`].
    pub scale: (f64, f64),
}

/// Returns the mean of a value over drives; NaN if there is none.
pub fn mean_of<'a>(
    drives: impl IntoIterator<Item = &'a DriveErrors>,
    value: impl Fn(&DriveErrors) -> f64,
) -> f64 {
    let values: Vec<f64> = drives.into_iter().map(value).collect();
    mean(&values)
}

impl ErrorSums {
    fn add(&mut self, found: Uncertain, true_percent: f64) {
        let error = f64::from(found.value) - true_percent;
        self.cells += 1.0;
        self.squared += error * error;
        self.normalised += (error / f64::from(found.sigma)).powi(2);
    }

    /// Returns the root mean square error, % grade.
    #[must_use]
    pub fn rmse(&self) -> f64 {
        (self.squared / self.cells).sqrt()
    }

    /// Returns the mean normalised squared error: 1 if the stated sigmas are consistent.
    #[must_use]
    pub fn nees(&self) -> f64 {
        self.normalised / self.cells
    }
}

impl DriveOnRoad {
    /// Simulates a drive of a truck along the road of `seed`. `receiver_m` is the receiver's slow
    /// altitude error (1 sigma, m).
    ///
    /// # Errors
    /// Returns an error if the truck comes to a stop on its road.
    pub fn new(seed: u64, truck: Preset, backward: bool, receiver_m: f64) -> Result<Self> {
        let text = scenario(seed, truck, backward, receiver_m);
        let scenario = Scenario::parse(&text, Path::new("a drive with wrong parameters"))?;
        Ok(Self {
            run: simulate(&scenario, 0)?,
            true_scale: scenario.runs[0].true_scale(),
        })
    }

    /// Estimates the drive without the signals in `missing`, and compares it with the truth. Returns
    /// `None` if there is no estimate.
    #[must_use]
    pub fn errors(&self, missing: &[Signal]) -> Option<DriveErrors> {
        let tuning = Tuning::default();
        let mut estimator = Estimator::<f32>::new(self.run.vehicle.model.clone(), tuning.clone())
            .expect("the simulator checked the vehicle");
        let samples = samples(&self.run, missing, &mut estimator);
        let mut context = Context::new(estimator.model().clone(), tuning)
            .expect("the estimator checked the vehicle");
        let (cells, scales) = cells(&mut context, &samples);
        if cells.is_empty() {
            return None;
        }
        let smoothed = smooth_run(&context, Known::default(), &samples);
        let judged = self.judged(cells.iter().map(|cell| cell.end));
        let mut errors = DriveErrors {
            smoothed: ErrorSums::default(),
            live: ErrorSums::default(),
            lagged: ErrorSums::default(),
            scale: scale_error(&cells, &scales, self.true_scale),
        };
        for ((cell, smoothed), true_percent) in cells.iter().zip(&smoothed).zip(judged) {
            if let Some(true_percent) = true_percent {
                let grade = smoothed.estimate.grade_percent;
                errors.smoothed.add(grade, true_percent);
                errors.live.add(cell.live_grade_percent, true_percent);
                errors.lagged.add(cell.lagged_grade_percent, true_percent);
            }
        }
        Some(errors)
    }

    /// Returns the true grade (%) of each cell that is judged, `None` for the others.
    fn judged(&self, ends: impl Iterator<Item = CellEnd> + Clone) -> Vec<Option<f64>> {
        let truth: Vec<(f64, f64)> = self
            .run
            .truth
            .iter()
            .map(|t| (t.time_s, t.grade_percent))
            .collect();
        let start = self.run.frames[0].time;
        let ends_m = between_cuts(ends.clone());
        ends.map(|end| {
            let time_s = end.time.since(start).as_secs_f64();
            linear(&truth, time_s).filter(|_| ends_m.contains(&end.distance_m()))
        })
        .collect()
    }
}

/// Returns the scenario: 40 km; mass, drag and rolling resistance wrong by 10 % (1 sigma), torque
/// by 4 %.
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

/// Passes the run's frames to the estimator, without the signals in `missing`.
fn samples(run: &SimulatedRun, missing: &[Signal], estimator: &mut Estimator<f32>) -> Vec<Sample> {
    let mut decoder = Decoder::new();
    let mut samples = Vec::new();
    for frame in &run.frames {
        decoder.decode(&frame.frame, |_, _, reading| {
            if missing.contains(&reading.signal) {
                return;
            }
            estimator.on_reading(frame.time, reading);
            while let Some(step) = estimator.step() {
                let sample = estimator.sample().filter(|_| step != Step::Smoothed);
                samples.extend(sample.copied());
                while estimator.next_cell().is_some() {}
            }
        });
    }
    samples
}

/// Returns the cells of the drive, and the live scale at the end of each.
fn cells(context: &mut Context, samples: &[Sample]) -> (Vec<Cell>, Vec<Uncertain>) {
    let mut estimator = CellEstimator::<f32>::new();
    let (mut cells, mut scales) = (Vec::new(), Vec::new());
    for sample in samples {
        if estimator.push_and_work(context, sample) {
            let live = estimator.live(context, sample);
            scales.push(live.map_or_else(Uncertain::default, |live| live.estimate.scale));
        }
        cells.extend(from_fn(|| estimator.next_cell(context)));
    }
    cells.extend(from_fn(|| estimator.drain_cell(context)));
    (cells, scales)
}

/// Returns the range of distances (m) that is judged, without the ends of the drive.
fn between_cuts(ends: impl Iterator<Item = CellEnd>) -> Range<f64> {
    let ends_m: Vec<f64> = ends.map(|end| end.distance_m()).collect();
    ends_m[0] + END_CUT_M..ends_m[ends_m.len() - 1] - END_CUT_M
}

fn scale_error(cells: &[Cell], scales: &[Uncertain], true_scale: f64) -> (f64, f64) {
    let at = cells.partition_point(|cell| cell.end.distance_m() < SCALE_AT_M);
    let scale = scales[at.min(scales.len() - 1)];
    (f64::from(scale.value) - true_scale, f64::from(scale.sigma))
}
