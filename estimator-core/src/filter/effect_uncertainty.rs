//! The force of the adopted effects, and the uncertainty of their amounts.
//!
//! An amount that is wrong by its sigma makes the model wrong by a slope that varies with the inputs
//! of the effect. At the start this is uncertainty of the bias. From then on only its change is new.
//! A change that takes some metres must add the square of all of it, not the squares of its steps:
//! each cell adds the part of the squared distance to a running mean that the mean forgets in this
//! cell, which for a step sums to the square of the step. A flickering input adds little.

use crate::cell::CELL_LENGTH_M;
use crate::context::Context;
use crate::effect::{Acts, MAX_EFFECTS};
use crate::model::AdoptedEffect;
use crate::sample::Sample;

/// Running means of the slope that the sigma of each effect makes, %.
#[derive(Clone, Copy, Debug, Default)]
pub struct EffectUncertainty {
    means: Option<[f32; MAX_EFFECTS]>,
}

/// What the adopted effects contribute in a cell.
#[derive(Clone, Copy, Debug, Default)]
pub struct EffectContribution {
    /// Resisting force besides that of the base model, N.
    pub force_n: f32,
    /// Variance that their uncertainty adds to the bias, %².
    pub bias_variance: f32,
}

impl EffectUncertainty {
    /// Creates the means before the first sample.
    pub const fn new() -> Self {
        Self { means: None }
    }

    /// Returns what the effects contribute in the cell of a sample, and follows their slopes.
    #[inline]
    pub fn advance(&mut self, context: &Context, sample: &Sample) -> EffectContribution {
        if context.model.effects.is_empty() {
            return EffectContribution::default();
        }
        self.sum(context, sample)
    }

    #[inline(never)]
    fn sum(&mut self, context: &Context, sample: &Sample) -> EffectContribution {
        let model = &context.model;
        // Part of the distance to a running mean that is left a cell later.
        let length_m = context.tuning.detection.turn_length_m;
        let keep = 1.0 / (1.0 + CELL_LENGTH_M / length_m);
        let is_first = self.means.is_none();
        let means = self.means.get_or_insert([0.0; MAX_EFFECTS]);
        let mut sum = EffectContribution::default();
        for (adopted, mean) in model.effects.iter().zip(means) {
            let force = adopted.force(&model.vehicle, sample);
            if adopted.effect.acts == Acts::Resists {
                sum.force_n += force.force_n;
            }
            if !acts_on_scale(adopted) {
                let slope = adopted.amount_sigma * force.slope_percent(sample);
                let distance = if is_first { 0.0 } else { slope - *mean };
                sum.bias_variance += (1.0 - keep * keep) * distance * distance;
                *mean = slope - keep * distance;
            }
        }
        sum
    }
}

/// Returns the variances of bias, %², and scale, 1, that the amounts make where a drive begins.
///
/// An error of mass or torque is one of the scale, which has its own state.
#[inline(never)] // Rare, and called from several places.
pub(super) fn initial_variances(context: &Context, sample: &Sample) -> (f32, f32) {
    let model = &context.model;
    let (mut bias, mut scale) = (0.0, 0.0);
    for adopted in model.effects.iter() {
        let sigma = adopted.amount_sigma;
        if acts_on_scale(adopted) {
            // As a part of the scale, which is true over modelled.
            let sigma = sigma / (1.0 + adopted.amount);
            scale += sigma * sigma;
        } else {
            let slope = sigma * adopted.force(&model.vehicle, sample).slope_percent(sample);
            bias += slope * slope;
        }
    }
    (bias, scale)
}

fn acts_on_scale(adopted: &AdoptedEffect) -> bool {
    matches!(adopted.effect.acts, Acts::Mass | Acts::Traction)
}
