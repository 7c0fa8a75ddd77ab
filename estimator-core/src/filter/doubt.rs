//! What is not sure of adopted effects.
//!
//! An amount that is wrong by its sigma makes the model wrong by a slope that comes and goes with
//! what the effect depends on. At the start that is uncertainty of the bias; from then on it is
//! the change that is new. A change that takes some metres adds the square of all of it, not of its
//! steps: each cell adds of the square of the distance to a running mean what that mean forgets of
//! it, which for a step comes to the square of the step. What only flickers adds little.

use crate::cell::CELL_LENGTH_M;
use crate::effect::{Acts, Adopted, MAX_EFFECTS};
use crate::sampler::Sample;
use crate::vehicle::VehicleParameters;

/// Way over which a change is one, m.
const CHANGE_LENGTH_M: f32 = 100.0;
/// Part of the distance to the running mean that is left a cell later.
const KEEP: f32 = 1.0 / (1.0 + CELL_LENGTH_M / CHANGE_LENGTH_M);

/// Running means of what the sigma of each effect makes of the slope, %.
#[derive(Clone, Copy, Debug)]
pub(super) struct Doubt {
    means: Option<[f32; MAX_EFFECTS]>,
}

impl Doubt {
    /// Before the first sample.
    pub(super) const fn new() -> Self {
        Self { means: None }
    }

    /// Goes over a cell: the variance that it adds to the bias, %².
    pub(super) fn pass(&mut self, vehicle: &VehicleParameters, sample: &Sample) -> f32 {
        let slopes = || slope_sigmas(vehicle, sample);
        let means = self.means.get_or_insert_with(|| {
            let mut means = [0.0; MAX_EFFECTS];
            for (mean, slope) in means.iter_mut().zip(slopes()) {
                *mean = slope;
            }
            means
        });
        let mut variance = 0.0;
        for (mean, slope) in means.iter_mut().zip(slopes()) {
            let away = slope - *mean;
            variance += (1.0 - KEEP * KEEP) * away * away;
            *mean = slope - KEEP * away;
        }
        variance
    }
}

/// Variances of bias, %², and scale where nothing is known yet but the amounts.
///
/// An error of mass or torque is one of the scale, which has a state of its own.
pub(super) fn variances(vehicle: &VehicleParameters, sample: &Sample) -> (f32, f32) {
    let bias = slope_sigmas(vehicle, sample)
        .map(|slope| slope * slope)
        .sum();
    let scale = vehicle
        .effects
        .iter()
        .filter(|adopted| is_scale(adopted))
        // Of what the scale is then: true over modelled.
        .map(|adopted| adopted.amount_sigma / (1.0 + adopted.amount))
        .map(|sigma| sigma * sigma)
        .sum();
    (bias, scale)
}

fn slope_sigmas(vehicle: &VehicleParameters, sample: &Sample) -> impl Iterator<Item = f32> {
    vehicle
        .effects
        .iter()
        .filter(|adopted| !is_scale(adopted))
        .map(|adopted| adopted.slope_sigma_percent(vehicle, sample))
}

fn is_scale(adopted: &Adopted) -> bool {
    matches!(adopted.effect.acts, Acts::Mass | Acts::Traction)
}
