//! The estimates that are judged: ours, the thesis's, the bare model, and none at all.

use crate::comparison::{ComparisonMethod, MeasuredDrive, pointwise, without_gaps};
use crate::error::Result;
use crate::files::run::RunRow;
use crate::files::vehicle::VehicleFile;
use crate::recorder::estimate_log;
use crate::score::rivals::samples_of_log;
use crate::source::read_options::ReadOptions;
use estimator_core::Tuning;
use estimator_core::sample::Sample;
use std::path::Path;

/// Name of the bare model.
pub(super) const BARE: &str = "bare model";

/// The grade of a cell.
#[derive(Clone, Copy)]
pub(super) struct EstimatedCell {
    pub driven_m: f64,
    pub grade_percent: f64,
    pub sigma_percent: Option<f64>,
}

/// An estimate of the whole drive.
pub(super) struct Estimate {
    pub name: &'static str,
    pub cells: Vec<EstimatedCell>,
    /// Whether its errors are those of the vehicle model, so that effects may explain them.
    pub is_of_the_vehicle: bool,
}

/// Makes all estimates of a log.
pub(super) fn estimates(log: &Path, vehicle: &VehicleFile) -> Result<Vec<Estimate>> {
    let samples = samples_of_log(log, vehicle)?;
    let none = samples.iter().map(|sample| EstimatedCell {
        driven_m: sample.end.distance_m(),
        grade_percent: 0.0,
        sigma_percent: None,
    });
    let estimate = |name, cells, is_of_the_vehicle| Estimate {
        name,
        cells,
        is_of_the_vehicle,
    };
    let mut all = vec![estimate("no grade", none.collect(), false)];
    let bare = by_part(&samples, vehicle, pointwise::grade_percent);
    all.push(estimate(BARE, bare, true));
    for method in ComparisonMethod::BOTH {
        let cells = by_part(&samples, vehicle, |drive| {
            method.estimate(drive).grade_percent
        });
        all.push(estimate(method.word(), cells, false));
    }
    let options = ReadOptions::default();
    let run = estimate_log::<f32>(
        &vehicle.model,
        &Tuning::default(),
        None,
        log,
        &options,
        |_| (),
    )?;
    let rows = run.in_memory()?.rows;
    let ours = |value: fn(&RunRow) -> (f64, f64)| {
        let cell = |row: &RunRow| {
            let (grade_percent, sigma_percent) = value(row);
            EstimatedCell {
                driven_m: row.distance_m,
                grade_percent,
                sigma_percent: Some(sigma_percent),
            }
        };
        rows.iter().map(cell).collect()
    };
    all.push(estimate("ours, smoothed", ours(RunRow::smoothed), true));
    all.push(estimate("ours, lagged", ours(RunRow::lagged), false));
    all.push(estimate("ours, live", ours(RunRow::live), false));
    Ok(all)
}

/// Estimates each part of the drive that has no gap.
fn by_part(
    samples: &[Sample],
    vehicle: &VehicleFile,
    grades: impl Fn(&MeasuredDrive) -> Vec<f64>,
) -> Vec<EstimatedCell> {
    let mut cells = Vec::with_capacity(samples.len());
    for part in without_gaps(samples) {
        let grades = grades(&MeasuredDrive::new(&vehicle.model.vehicle, part));
        cells.extend(
            part.iter()
                .zip(grades)
                .map(|(sample, grade_percent)| EstimatedCell {
                    driven_m: sample.end.distance_m(),
                    grade_percent,
                    sigma_percent: None,
                }),
        );
    }
    cells
}
