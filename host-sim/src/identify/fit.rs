//! Resistance, drag and traction, from the innovations of the filter (see
//! [`evidence`](crate::diagnose::evidence)).

use super::estimate::Estimate;
use crate::diagnose::drive::LoggedDrive;
use crate::diagnose::evidence::{Evidence, ForceColumn, WINDS_MPS, judging_tuning, segments};
use crate::diagnose::regression::{Basis, Fit, Regression};
use estimator_core::effect::{Effect, air_drag, mass, rolling_resistance, torque_scale};
use estimator_core::{Model, Sample, Traction, Tuning, VehicleParameters};
use rayon::prelude::*;
use std::f64::consts::PI;

/// Engine speed below which no gear is engaged for long, rpm.
const IDLE_RPM: f64 = 700.0;

/// A drive with the model that it was read with.
pub struct FittedDrive {
    /// The model. Its mass is the drive's own.
    pub model: Model,
    /// The drive.
    pub logged: LoggedDrive,
}

/// Standard deviations of what is usual.
#[derive(Clone, Copy, Debug)]
pub struct Priors {
    /// Of the coefficient of rolling resistance.
    pub rolling_resistance: f64,
    /// Of the drag area, m².
    pub drag_area_m2: f64,
    /// Of the traction, relative.
    pub traction: f64,
    /// Of the mass of each drive, relative.
    pub mass: f64,
}

/// Amounts to add to the parameters of the models.
#[derive(Clone, Debug)]
pub struct Amounts {
    /// To the coefficient of rolling resistance.
    pub rolling_resistance: Estimate,
    /// To the drag area, m².
    pub drag_area_m2: Estimate,
    /// To the traction, relative.
    pub traction: Estimate,
    /// To the mass of each drive, relative.
    pub mass: Vec<Estimate>,
}

/// The columns that all drives share. Each drive has one more, for its mass.
static COMMON: [&Effect; 3] = [
    &rolling_resistance::EFFECT,
    &air_drag::EFFECT,
    &torque_scale::EFFECT,
];

/// Fits the amounts to all drives. `None` if they cannot be separated even with the priors.
#[must_use]
pub fn fit(drives: &[FittedDrive], priors: &Priors, tuning: &Tuning) -> Option<Amounts> {
    let basis = basis(drives.len(), priors);
    let columns: Vec<Vec<ForceColumn>> = (0..drives.len())
        .into_par_iter()
        .map(|number| columns(drives, number))
        .collect();
    let mut best: Option<(f64, Fit)> = None;
    for wind_mps in WINDS_MPS {
        let tuning = judging_tuning(tuning, wind_mps);
        let evidence: Evidence = drives
            .par_iter()
            .zip(&columns)
            .enumerate()
            .map(|(number, (drive, columns))| {
                segments(number, &drive.logged, &drive.model, &tuning, columns)
            })
            .collect::<Vec<_>>()
            .into_iter()
            .flatten()
            .collect();
        let regression = Regression::new(&evidence, |_| false);
        let misfit = regression.negative_log_likelihood() - regression.explained(&basis);
        if best.as_ref().is_none_or(|(least, _)| misfit < *least) {
            best = regression.fit(&basis).map(|fit| (misfit, fit)).or(best);
        }
    }
    let (_, fit) = best?;
    let at = |index: usize| {
        Estimate::new(
            fit.amounts[index],
            fit.covariance[(index, index)].max(0.0).sqrt(),
        )
    };
    Some(Amounts {
        rolling_resistance: at(0),
        drag_area_m2: at(1),
        traction: at(2),
        mass: (0..drives.len()).map(|number| at(3 + number)).collect(),
    })
}

/// Returns the speed at which the engine idles in the lowest gear of the file, m/s. Below, the vehicle is
/// in a gear that the file does not have.
fn slowest_mps(vehicle: &VehicleParameters) -> f64 {
    let Traction::Powertrain(powertrain) = &vehicle.traction else {
        return 0.0;
    };
    let lowest = powertrain.gears.iter().map(|gear| f64::from(gear.ratio));
    let lowest = lowest.fold(0.0, f64::max);
    let turns_per_m =
        lowest * f64::from(powertrain.final_drive_ratio) / f64::from(vehicle.wheel_radius_m);
    if turns_per_m > 0.0 {
        IDLE_RPM * PI / 30.0 / turns_per_m
    } else {
        0.0
    }
}

fn basis(drives: usize, priors: &Priors) -> Basis {
    let common = [
        priors.rolling_resistance,
        priors.drag_area_m2,
        priors.traction,
    ];
    let sigmas = common.into_iter().chain((0..drives).map(|_| priors.mass));
    sigmas
        .enumerate()
        .fold(Basis::default(), |basis, (column, sigma)| {
            basis.with(&[vec![column]], sigma)
        })
}

/// Returns the forces of all columns on one drive, N.
fn columns(drives: &[FittedDrive], number: usize) -> Vec<ForceColumn> {
    let FittedDrive { model, logged } = &drives[number];
    let slowest_mps = slowest_mps(&model.vehicle);
    let of = |effect: &Effect| -> ForceColumn {
        // In a gear that the file does not have, and without traction, acceleration says nothing about
        // the mass.
        let force = |sample: &Sample| {
            let end = &sample.end;
            if end.condition.no_traction || f64::from(end.speed_mps) < slowest_mps {
                return 0.0;
            }
            effect.derivative_n(&model.vehicle, sample, &Default::default(), 0.0)
        };
        logged.samples.iter().map(force).collect()
    };
    let masses = (0..drives.len()).map(|other| {
        if other == number {
            of(&mass::EFFECT)
        } else {
            vec![0.0; logged.samples.len()]
        }
    });
    COMMON.into_iter().map(of).chain(masses).collect()
}
