//! Comparison estimates from the same log: the thesis's two methods, and an oracle.

use crate::comparison::{ComparisonMethod, MeasuredDrive, without_gaps};
use crate::error::{Error, Result};
use crate::files::oracle::OracleFile;
use crate::files::run::RunRow;
use crate::files::vehicle::VehicleFile;
use crate::recorder::{Recorder, SmoothedRun};
use crate::source::input::{LogInput, for_each_input};
use crate::source::read_options::ReadOptions;
use estimator_core::sample::Sample;
use estimator_core::{
    CELL_LENGTH_M, Context, Instant, Intake, Model, ParameterError, Sampler, Tuning,
};
use std::iter::from_fn;
use std::path::Path;

/// Names of the oracle's three estimates.
pub const ORACLE: [&str; 3] = ["oracle", "oracle_lagged", "oracle_live"];

/// Largest time difference of the same cell, s. Both times come from the same readings; they differ
/// by the rounding of a RUN.csv.
const SAME_TIME_S: f64 = 0.002;

/// A comparison estimate of a drive.
#[derive(Clone, Debug)]
pub struct Rival {
    /// Name in the table.
    pub estimate: &'static str,
    /// Its cells, in order.
    cells: Vec<RivalCell>,
}

#[derive(Clone, Copy, Debug)]
struct RivalCell {
    number: u32,
    time_s: f64,
    grade_percent: f64,
    sigma_percent: f64,
}

impl Rival {
    /// Returns grade and its standard deviation, %, in the cell of a run's row; `None` without a
    /// cell at that time.
    #[must_use]
    pub fn at(&self, row: &RunRow) -> Option<(f64, f64)> {
        let number = number_of(row);
        let found = self
            .cells
            .binary_search_by_key(&number, |cell| cell.number)
            .ok()?;
        let cell = &self.cells[found];
        ((cell.time_s - row.time_s).abs() < SAME_TIME_S)
            .then_some((cell.grade_percent, cell.sigma_percent))
    }
}

fn number_of(row: &RunRow) -> u32 {
    (row.distance_m / f64::from(CELL_LENGTH_M)).round() as u32
}

/// Intake and sampler of the core, without its filter.
struct Sampling {
    context: Context,
    intake: Intake,
    sampler: Sampler,
}

impl Sampling {
    fn of(model: Model) -> std::result::Result<Self, ParameterError> {
        let context = Context::new(model, Tuning::default())?;
        Ok(Self {
            intake: Intake::new(&context.tuning),
            context,
            sampler: Sampler::new(),
        })
    }

    fn on_input(&mut self, input: &LogInput, samples: &mut Vec<Sample>) {
        let Self {
            context,
            intake,
            sampler,
        } = self;
        match input {
            LogInput::Frame(frame) => intake.on_frame(context, frame.time, &frame.frame, sampler),
            LogInput::Reading(time, reading) => {
                intake.on_reading(context, *time, *reading, sampler)
            }
        };
        samples.extend(from_fn(|| sampler.next_sample()));
    }
}

/// Returns the samples of a log, as the estimator takes them.
///
/// # Errors
/// Returns an error, with file and line, if the log cannot be read to its end, or if the vehicle is
/// impossible.
pub fn samples_of_log(log: &Path, vehicle: &VehicleFile) -> Result<Vec<Sample>> {
    let sampling = Sampling::of(vehicle.model.clone());
    let mut sampling = sampling.map_err(|e| Error::content(log, e.to_string()))?;
    let mut samples = Vec::new();
    for_each_input(
        log,
        &ReadOptions::default(),
        |_| (),
        |input| sampling.on_input(&input, &mut samples),
    )?;
    Ok(samples)
}

/// Estimates a run's log by the thesis's methods (if the assumed vehicle is given) and by an
/// oracle (if it is given). `run_mps` is the mean speed of the run.
///
/// # Errors
/// Returns an error, with file and line, if the log cannot be read to its end, or if a vehicle is
/// impossible.
pub fn of_log(
    log: &Path,
    assumed: Option<&VehicleFile>,
    oracle: Option<&OracleFile>,
    run_mps: f64,
) -> Result<Vec<Rival>> {
    let impossible = |e: &dyn ToString| Error::content(log, e.to_string());
    let mut sampling = assumed
        .map(|vehicle| Sampling::of(vehicle.model.clone()))
        .transpose()
        .map_err(|e| impossible(&e))?;
    // In double precision, because the oracle has parameters with variances near zero.
    let mut oracle_recorder = oracle
        .map(|oracle| Recorder::<f64>::new(oracle.vehicle.model.clone(), oracle.tuning(run_mps)))
        .transpose()
        .map_err(|e| impossible(&e))?;
    let mut start = None;
    let mut samples = Vec::new();
    for_each_input(
        log,
        &ReadOptions::default(),
        |_| (),
        |input| {
            start.get_or_insert(input.time());
            if let Some(sampling) = &mut sampling {
                sampling.on_input(&input, &mut samples);
            }
            if let Some(recorder) = &mut oracle_recorder {
                recorder.on_input(&input.without_mass());
            }
        },
    )?;
    let mut rivals = Vec::new();
    if let Some(vehicle) = assumed {
        let start = start.unwrap_or_default();
        rivals.extend(
            ComparisonMethod::BOTH.map(|method| by_method(method, vehicle, &samples, start)),
        );
    }
    if let Some(recorder) = oracle_recorder {
        rivals.extend(of_run(&recorder.finish()?));
    }
    Ok(rivals)
}

fn by_method(
    method: ComparisonMethod,
    vehicle: &VehicleFile,
    samples: &[Sample],
    start: Instant,
) -> Rival {
    let mut cells = Vec::with_capacity(samples.len());
    for part in without_gaps(samples) {
        let profile = method.estimate(&MeasuredDrive::new(&vehicle.model.vehicle, part));
        let estimates = profile.grade_percent.iter().zip(&profile.sigma_percent);
        cells.extend(
            part.iter()
                .zip(estimates)
                .map(|(sample, (grade, sigma))| RivalCell {
                    number: sample.end.cell,
                    time_s: sample.end.time.since(start).as_secs_f64(),
                    grade_percent: *grade,
                    sigma_percent: *sigma,
                }),
        );
    }
    Rival {
        estimate: method.word(),
        cells,
    }
}

/// Returns the oracle's estimates: smoothed, lagged, live.
fn of_run(run: &SmoothedRun) -> [Rival; 3] {
    let rival = |estimate, value: fn(&RunRow) -> (f64, f64)| Rival {
        estimate,
        cells: run
            .rows
            .iter()
            .map(|row| {
                let (grade_percent, sigma_percent) = value(row);
                RivalCell {
                    number: number_of(row),
                    time_s: row.time_s,
                    grade_percent,
                    sigma_percent,
                }
            })
            .collect(),
    };
    let [smoothed, lagged, live] = ORACLE;
    [
        rival(smoothed, RunRow::smoothed),
        rival(lagged, RunRow::lagged),
        rival(live, RunRow::live),
    ]
}
