//! What a run is judged beside, on the same traffic: the thesis's two methods, and an oracle.

use crate::comparison::{Drive, Method, without_gaps};
use crate::error::{Error, Result};
use crate::files::oracle::OracleFile;
use crate::files::run::RunRow;
use crate::files::vehicle::VehicleFile;
use crate::recorder::{Recorder, Run};
use crate::source::input::{Input, for_each_input};
use estimator_core::sampler::Sample;
use estimator_core::{CELL_LENGTH_M, Instant, Intake, Tuning};
use std::path::Path;

/// Names of the oracle's three estimates.
pub const ORACLE: [&str; 3] = ["oracle", "oracle_lagged", "oracle_live"];

/// Times of the same cell differ by less, s: both come from the same readings, and differ by what a
/// RUN.csv rounds away.
const SAME_TIME_S: f64 = 0.002;

/// Another estimate of a drive.
#[derive(Clone, Debug)]
pub struct Rival {
    /// What it is called in the table.
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
    /// Grade and its standard deviation, %, in the cell of a run's row; `None` if it has no such
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

/// Estimates a run's log by the thesis's methods (if the believed vehicle is known) and by an
/// oracle (if it is). `run_mps` is the mean speed of the run.
///
/// # Errors
/// A log that cannot be read to its end, with file and line; an impossible vehicle.
pub fn of_log(
    log: &Path,
    believed: Option<&VehicleFile>,
    oracle: Option<&OracleFile>,
    run_mps: f64,
) -> Result<Vec<Rival>> {
    let impossible = |e: &dyn ToString| Error::content(log, e.to_string());
    let mut intake = believed
        .map(|vehicle| Intake::new(vehicle.parameters.clone(), Tuning::default()))
        .transpose()
        .map_err(|e| impossible(&e))?;
    // In double precision: what is known nearly exactly has variances near nothing.
    let mut knowing = oracle
        .map(|oracle| {
            Recorder::<f64>::new(oracle.vehicle.parameters.clone(), oracle.tuning(run_mps))
        })
        .transpose()
        .map_err(|e| impossible(&e))?;
    let mut start = None;
    let mut samples = Vec::new();
    for_each_input(
        log,
        |_| (),
        |input| {
            start.get_or_insert(input.time());
            if let Some(intake) = &mut intake {
                match &input {
                    Input::Frame(frame) => intake.on_frame(frame.time, &frame.frame),
                    Input::Reading(time, reading) => intake.on_reading(*time, *reading),
                };
                while let Some(sample) = intake.next_sample() {
                    samples.push(sample);
                }
            }
            if let Some(recorder) = &mut knowing {
                recorder.on_input(&input.without_mass());
            }
        },
    )?;
    let mut rivals = Vec::new();
    if let Some(vehicle) = believed {
        let start = start.unwrap_or_default();
        rivals.extend(Method::BOTH.map(|method| by_method(method, vehicle, &samples, start)));
    }
    if let Some(recorder) = knowing {
        rivals.extend(of_run(&recorder.finish()?));
    }
    Ok(rivals)
}

fn by_method(method: Method, vehicle: &VehicleFile, samples: &[Sample], start: Instant) -> Rival {
    let mut cells = Vec::with_capacity(samples.len());
    for part in without_gaps(samples) {
        let profile = method.estimate(&Drive::new(&vehicle.parameters, part));
        let estimates = profile.grade_percent.iter().zip(&profile.sigma_percent);
        cells.extend(
            part.iter()
                .zip(estimates)
                .map(|(sample, (grade, sigma))| RivalCell {
                    number: sample.place.cell,
                    time_s: sample.place.time.since(start).micros() as f64 * 1e-6,
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

/// The oracle's run: smoothed, lagged, live.
fn of_run(run: &Run) -> [Rival; 3] {
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
