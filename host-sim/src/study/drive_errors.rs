//! Errors of the estimator on simulated drives whose parameters are wrong.

use crate::error::Result;
use crate::numeric::series::linear;
use crate::numeric::statistics::mean;
use crate::score::END_CUT_M;
use crate::simulator::scenario::Scenario;
use crate::simulator::truck::Preset;
use crate::simulator::{SimulatedRun, simulate};
use crate::smooth::{ForwardCell, smooth_run};
use estimator_core::filter::{Filter, Quantity, SensorNoiseRatios};
use estimator_core::signal::{Decoder, Signal};
use estimator_core::smoother::BackwardPass;
use estimator_core::smoother::fixed_lag::BLOCK_CELLS;
use estimator_core::{Context, Estimator, Sample, Tuning, Uncertain};
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
    /// Errors of the lagged grade, for each requested lag.
    pub lagged: Vec<ErrorSums>,
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

    /// Estimates the drive without the signals in `missing`, and compares it with the truth. `lags`
    /// are in blocks of cells. Returns `None` if there is no estimate.
    #[must_use]
    pub fn errors(&self, missing: &[Signal], lags: &[usize]) -> Option<DriveErrors> {
        let tuning = Tuning::default();
        let mut estimator = Estimator::<f32>::new(self.run.vehicle.model.clone(), tuning.clone())
            .expect("the simulator checked the vehicle");
        let samples = samples(&self.run, missing, &mut estimator);
        let mut filter = Filter::<f32>::new(&tuning, &SensorNoiseRatios::default(), None);
        let mut context = Context::new(estimator.model().clone(), tuning.clone())
            .expect("the estimator checked the vehicle");
        let cells: Vec<ForwardCell<f32>> = samples
            .iter()
            .filter_map(|sample| ForwardCell::step(&mut filter, &mut context, sample))
            .collect();
        if cells.is_empty() {
            return None;
        }
        let smoothed = smooth_run(
            estimator.model(),
            &tuning,
            &estimator.second_pass_filter::<f64>(),
            &samples,
        );
        let judged = self.judged(&cells);

        let mut errors = DriveErrors {
            smoothed: ErrorSums::default(),
            live: ErrorSums::default(),
            lagged: Vec::new(),
            scale: scale_error(&cells, self.true_scale),
        };
        for (k, true_percent) in judged.iter().enumerate() {
            if let Some(true_percent) = true_percent {
                errors
                    .smoothed
                    .add(smoothed[k].estimate.grade_percent, *true_percent);
                errors.live.add(
                    cells[k].state.quantity(Quantity::Slope).grade(),
                    *true_percent,
                );
            }
        }
        errors.lagged = lags
            .iter()
            .map(|lag| lagged(&cells, &judged, *lag))
            .collect();
        Some(errors)
    }

    /// Returns the true grade (%) of each cell that is judged, `None` for the others.
    fn judged(&self, cells: &[ForwardCell<f32>]) -> Vec<Option<f64>> {
        let truth: Vec<(f64, f64)> = self
            .run
            .truth
            .iter()
            .map(|t| (t.time_s, t.grade_percent))
            .collect();
        let start = self.run.frames[0].time;
        let ends_m = between_cuts(cells);
        cells
            .iter()
            .map(|cell| {
                let end = &cell.record.end;
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
            while estimator.step().is_some() {
                samples.extend(estimator.sample().copied());
                while estimator.next_cell().is_some() {}
            }
        });
    }
    samples
}

/// Returns the range of distances (m) that is judged, without the ends of the drive.
fn between_cuts(cells: &[ForwardCell<f32>]) -> Range<f64> {
    let end_m = |cell: &ForwardCell<f32>| cell.record.end.distance_m();
    end_m(&cells[0]) + END_CUT_M..end_m(&cells[cells.len() - 1]) - END_CUT_M
}

/// Judges the lagged grades. The core finishes cells one block at a time.
fn lagged(cells: &[ForwardCell<f32>], judged: &[Option<f64>], lag_blocks: usize) -> ErrorSums {
    let mut errors = ErrorSums::default();
    for from in (0..cells.len()).step_by(BLOCK_CELLS) {
        let block = from..(from + BLOCK_CELLS).min(cells.len());
        let to = (block.end + lag_blocks * BLOCK_CELLS).min(cells.len());
        let mut pass = BackwardPass::new();
        for k in (from..to).rev() {
            if let Some(true_percent) = judged[k].filter(|_| block.contains(&k)) {
                let slope = cells[k].state.quantity(Quantity::Slope);
                errors.add(pass.smooth(&slope).grade(), true_percent);
            }
            pass.retreat(&cells[k].record.smoother_input);
        }
    }
    errors
}

fn scale_error(cells: &[ForwardCell<f32>], true_scale: f64) -> (f64, f64) {
    let at = cells.partition_point(|cell| cell.record.end.distance_m() < SCALE_AT_M);
    let state = &cells[at.min(cells.len() - 1)].state;
    let scale = state.quantity(Quantity::Scale).uncertain().plus(1.0);
    (f64::from(scale.value) - true_scale, f64::from(scale.sigma))
}
