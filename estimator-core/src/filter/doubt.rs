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

/// Effects in a cell.
#[derive(Clone, Copy, Debug, Default)]
pub struct Felt {
    /// Force that resists besides what the base model has, N.
    pub force_n: f32,
    /// Variance that what is not sure of them adds to the bias, %².
    pub doubt: f32,
}

impl Doubt {
    /// Before the first sample.
    pub(super) const fn new() -> Self {
        Self { means: None }
    }

    /// Goes over a cell.
    #[inline]
    pub(super) fn pass(&mut self, vehicle: &VehicleParameters, sample: &Sample) -> Felt {
        if vehicle.effects.is_empty() {
            return Felt::default();
        }
        self.sum(vehicle, sample)
    }

    #[inline(never)]
    fn sum(&mut self, vehicle: &VehicleParameters, sample: &Sample) -> Felt {
        let begins = self.means.is_none();
        let means = self.means.get_or_insert([0.0; MAX_EFFECTS]);
        let (mut force_n, mut doubt) = (0.0, 0.0);
        for (adopted, mean) in vehicle.effects.iter().zip(means) {
            let force = adopted.force(vehicle, sample);
            if adopted.effect.acts == Acts::Resists {
                force_n += force.force_n;
            }
            if !is_scale(adopted) {
                let slope = adopted.amount_sigma * force.slope_percent(sample);
                let away = if begins { 0.0 } else { slope - *mean };
                doubt += (1.0 - KEEP * KEEP) * away * away;
                *mean = slope - KEEP * away;
            }
        }
        Felt { force_n, doubt }
    }
}

/// Variances of bias, %², and scale where nothing is known yet but the amounts.
///
/// An error of mass or torque is one of the scale, which has a state of its own.
pub(super) fn variances(vehicle: &VehicleParameters, sample: &Sample) -> (f32, f32) {
    let (mut bias, mut scale) = (0.0, 0.0);
    for adopted in vehicle.effects.iter() {
        let sigma = adopted.amount_sigma;
        if is_scale(adopted) {
            // Of what the scale is then: true over modelled.
            let sigma = sigma / (1.0 + adopted.amount);
            scale += sigma * sigma;
        } else {
            let slope = sigma * adopted.force(vehicle, sample).slope_percent(sample);
            bias += slope * slope;
        }
    }
    (bias, scale)
}

fn is_scale(adopted: &Adopted) -> bool {
    matches!(adopted.effect.acts, Acts::Mass | Acts::Traction)
}
