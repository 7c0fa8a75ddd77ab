//! Gross mass of the vehicle: what the scale of the model means for a user.
//!
//! The scale is true over modelled traction per kilogram. If the torque is right, the mass is that of
//! the model over the scale. An engine reports its torque within some per cent, which no signal on
//! the bus can tell from mass: it is part of the sigma. Where the mass of the model was told, by the
//! bus or by an adopted effect with a sigma, both are combined by their inverse variances. If they
//! differ by more than their sigmas allow, the sigma grows to cover both (R. T. Birge, "The
//! calculation of errors by the method of least squares", Phys. Rev. 40:207, 1932).

use crate::cell::Uncertain;
use crate::context::Context;
use crate::model::Model;
use crate::sample::Sample;
use crate::scalar::Scalar;
use crate::tuning::Prior;
use crate::vehicle::Traction;

/// Smallest and largest scale that a vehicle can have. A full combination and its tractor alone are
/// a factor of 5 apart.
const SMALLEST_SCALE: f32 = 0.2;
const LARGEST_SCALE: f32 = 5.0;

/// The mass that the model takes, and how well it and the traction are known.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ModelMass {
    /// Mass that the model takes, kg.
    pub mass_kg: f32,
    /// Variance of the traction, as a part of it.
    pub traction_variance: f32,
    /// Variance of the mass, as a part of it. `None` if it is only a parameter, which another load
    /// makes wrong by any factor.
    pub told_variance: Option<f32>,
}

impl ModelMass {
    /// Returns what is known of the mass in the cell of a sample.
    #[inline]
    #[must_use]
    pub fn of(context: &Context, sample: &Sample) -> Self {
        let Context { model, tuning, .. } = context;
        let mut variance = model.effects.mass_variance();
        if sample.mass_is_reported {
            let sigma = tuning.measurement_noise.reported_mass_sigma;
            variance += sigma * sigma;
        }
        Self {
            told_variance: (variance > 0.0).then_some(variance),
            ..Self::parameter(model, &tuning.prior, sample.forces.mass_kg)
        }
    }

    /// Returns a mass in kg that nothing confirms.
    #[inline]
    #[must_use]
    pub fn parameter(model: &Model, tuning: &Prior, mass_kg: f32) -> Self {
        Self {
            mass_kg,
            traction_variance: match model.vehicle.traction {
                Traction::Powertrain(_) => tuning.torque_sigma * tuning.torque_sigma,
                Traction::Force => 0.0,
            },
            told_variance: None,
        }
    }

    /// Returns the gross mass for a scale, kg.
    #[inline]
    #[must_use]
    pub fn gross_kg(&self, scale: Uncertain) -> Uncertain {
        let possible = possible_scale(scale.value);
        let beyond = scale.value - possible;
        // As parts of the mass of the model.
        let driven = 1.0 / possible;
        let driven_variance = driven
            * driven
            * ((scale.sigma * scale.sigma + beyond * beyond) * (driven * driven)
                + self.traction_variance);
        let (part, variance) = match self.told_variance {
            Some(variance) => combined((driven, driven_variance), (1.0, variance)),
            None => (driven, driven_variance),
        };
        Uncertain {
            value: self.mass_kg * part,
            sigma: self.mass_kg * Scalar::sqrt(variance),
        }
    }
}

/// Returns the scale that a vehicle can have, nearest to this one.
pub(super) fn possible_scale(scale: f32) -> f32 {
    Scalar::min(LARGEST_SCALE, Scalar::max(SMALLEST_SCALE, scale))
}

/// Returns mean and variance of two independent measurements with their variances, of which the
/// second is above zero.
#[inline(never)] // It is rare, and takes room in each of its callers.
fn combined((a, a_variance): (f32, f32), (b, b_variance): (f32, f32)) -> (f32, f32) {
    let sum = a_variance + b_variance;
    let mean = (a * b_variance + b * a_variance) / sum;
    let chi_squared = (a - b) * (a - b) / sum;
    (
        mean,
        a_variance * b_variance / sum * Scalar::max(1.0, chi_squared),
    )
}
