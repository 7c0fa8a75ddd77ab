//! What is known of a cell, and what another drive over it adds.
//!
//! The drives are of one vehicle. Its wrong parameters, and the model's flattening of crests, are in
//! all of them alike: a share ρ of the variance does not average out. For n drives of equal variance
//! v the variance of the mean is v (ρ + (1 − ρ)/n), as in the fusion of maps. From the variance and
//! n, both parts follow; nothing else is stored.

use crate::cell::Uncertain;
use crate::roadmap::block_cells::MapCell;
use libm::sqrtf;

/// Share of the variance that all drives of a vehicle have in common: the usual share of sessions in
/// the fusion of maps. Simulated drives with the same wrong parameters and other winds share less.
pub(super) const COMMON_SHARE: f32 = 0.1;
/// Drives that count: roads change, and so does the vehicle. Older ones then fade.
const MOST_DRIVES: u16 = 30;
/// Mean squared difference, in standard deviations, from which the road counts as rebuilt: what was
/// known of it loses weight by this factor.
const REBUILT: f32 = 9.0;
/// Limits of a variance, %²: those of the stored form.
const VARIANCE_LIMITS: (f32, f32) = (1e-6, 1e3);

/// What is known of a cell.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Known {
    /// Grade, %.
    pub(super) grade_percent: f32,
    /// Its variance, %².
    pub(super) variance: f32,
    pub(super) altitude_m: Option<f32>,
    /// Number of drives.
    pub(super) runs: u16,
}

/// The two parts of a variance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Parts {
    /// In each drive another.
    pub(super) own: f32,
    /// In all drives of the vehicle alike.
    pub(super) common: f32,
}

impl Parts {
    /// Returns the parts of the variance of the mean of some drives.
    pub(super) fn of(variance: f32, runs: u16) -> Self {
        let own = (1.0 - COMMON_SHARE) / f32::from(runs.max(1));
        let own = variance * own / (COMMON_SHARE + own);
        Self {
            own,
            common: variance - own,
        }
    }
}

impl Known {
    /// Returns what a block says of a cell.
    pub(super) fn of(cell: &MapCell) -> Self {
        let sigma = cell.grade_sigma_percent;
        Self {
            grade_percent: cell.grade_percent,
            variance: sigma * sigma,
            altitude_m: cell.altitude_m,
            runs: cell.runs.min(u16::MAX.into()) as u16,
        }
    }

    /// Returns what one drive says of a cell; `None` if that cannot be.
    pub(super) fn of_drive(grade: Uncertain, altitude_m: Option<f32>) -> Option<Self> {
        grade.is_possible_grade().then(|| Self {
            grade_percent: grade.value,
            variance: (grade.sigma * grade.sigma).clamp(VARIANCE_LIMITS.0, VARIANCE_LIMITS.1),
            altitude_m: altitude_m.filter(|altitude| altitude.abs() < 1e4),
            runs: 1,
        })
    }

    /// Returns what is between two cells.
    pub(super) fn between(a: &Self, b: &Self, part: f32) -> Self {
        let mix = |a: f32, b: f32| a + part * (b - a);
        Self {
            grade_percent: mix(a.grade_percent, b.grade_percent),
            variance: mix(a.variance, b.variance),
            altitude_m: a.altitude_m.zip(b.altitude_m).map(|(a, b)| mix(a, b)),
            runs: 1,
        }
    }

    /// Returns the squared difference of a drive from what is known, in standard deviations. Common
    /// errors do not differ.
    pub(super) fn squared_difference(&self, drive: &Self) -> f32 {
        let difference = drive.grade_percent - self.grade_percent;
        let variance = Parts::of(self.variance, self.runs).own + Parts::of(drive.variance, 1).own;
        difference * difference / variance.max(VARIANCE_LIMITS.0)
    }

    /// Adds a drive. `misfit` is the mean squared difference around the cell, in standard deviations:
    /// where it is too large, the road was rebuilt, and what was known loses weight.
    pub(super) fn add(&mut self, drive: &Self, misfit: f32) {
        if misfit > REBUILT {
            self.variance = (self.variance * misfit).min(VARIANCE_LIMITS.1);
            self.runs = 1;
        }
        let (known, new) = (
            Parts::of(self.variance, self.runs),
            Parts::of(drive.variance, 1),
        );
        let weight = new.own / (known.own + new.own);
        let mix = |known: f32, new: f32| weight * known + (1.0 - weight) * new;
        let common = mix(sqrtf(known.common), sqrtf(new.common));
        let own = weight * weight * known.own + (1.0 - weight) * (1.0 - weight) * new.own;
        let variance = own + common * common;
        if !variance.is_finite() {
            return;
        }
        self.grade_percent = mix(self.grade_percent, drive.grade_percent);
        self.variance = variance.clamp(VARIANCE_LIMITS.0, VARIANCE_LIMITS.1);
        self.altitude_m = match (self.altitude_m, drive.altitude_m) {
            (Some(known), Some(new)) => Some(mix(known, new)),
            (known, new) => known.or(new),
        };
        self.runs = (self.runs + 1).min(MOST_DRIVES);
    }
}
