//! What an effect is: its description, its force, and how a search varies it.

use crate::maybe::Maybe;
use crate::sample::Sample;
use crate::vehicle::VehicleParameters;
use crate::vehicle::parameter_check::{ParameterError, check};

/// Largest number of parameters that an effect has besides its amount.
pub const MAX_EFFECT_PARAMETERS: usize = 3;

/// Parameter values of an effect, in the order of [`Effect::parameters`].
pub type ParameterValues = [Maybe; MAX_EFFECT_PARAMETERS];

/// An effect that the base model lacks.
#[derive(Debug)]
pub struct Effect {
    /// Number in stored data: vehicle images in flash. It is never changed and never used again,
    /// so that data outlive releases.
    pub number: u8,
    /// Name in vehicle files and reports.
    pub name: &'static str,
    /// Unit of the amount; "1" if it has none.
    pub unit: &'static str,
    /// Standard deviation of the amounts that vehicles and roads have, in the effect's unit.
    pub typical: f32,
    /// Amounts that are possible.
    pub range: Bounds,
    /// Parameters besides the amount.
    pub parameters: &'static [EffectParameter],
    /// Where it enters the model.
    pub acts: Acts,
    /// How [`force`](Self::force) is computed.
    pub physics: Physics,
}

/// A parameter of an effect besides its amount.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EffectParameter {
    /// Key in the vehicle file, with its unit.
    pub key: &'static str,
    /// Its meaning, and what its absence means.
    pub about: &'static str,
    /// Value where none is given; [`Maybe::NONE`] stays absent.
    pub default: Maybe,
    /// Values that are possible.
    pub range: Bounds,
}

/// A closed range, and its description.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds {
    /// Smallest value.
    pub low: f32,
    /// Largest value.
    pub high: f32,
    /// The range in words, with its unit.
    pub words: &'static str,
}

/// The force that a model without an effect misses in a cell.
#[derive(Clone, Copy, Debug)]
pub enum Physics {
    /// In proportion to the amount: N per unit of the amount.
    PerUnit(fn(&VehicleParameters, &Sample, &ParameterValues) -> f32),
    /// In any other way: N for an amount, which is the last argument.
    Of(fn(&VehicleParameters, &Sample, &ParameterValues, f32) -> f32),
}

/// The force of an effect in a cell.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Force {
    /// The force, positive if it resists, N.
    pub force_n: f32,
    /// Its derivative with respect to the amount, N per unit of the amount.
    pub per_unit_n: f32,
}

/// Where an effect enters the model.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Acts {
    /// As a resisting force.
    Resists,
    /// As a scale factor 1 + amount on the mass, whether it is a parameter or comes from the bus.
    Mass,
    /// As a scale factor 1 + amount on the traction force, whatever its source.
    Traction,
    /// As a scale factor 1 + amount on the wheel radius: speed and distance grow, the force of a
    /// torque shrinks.
    WheelRadius,
}

/// What an effect is, in words. It is a static of its own, so that it takes no flash on a target.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Description {
    /// Its physics in a sentence.
    pub about: &'static str,
    /// Source of its physics and of the usual amounts.
    pub source: &'static str,
}

/// How the diagnosis on a host searches for an effect. It is a static of its own, so that it takes
/// no flash on a target.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Search {
    /// What the search varies.
    pub varies: Varies,
    /// Whether the effect is a wrong parameter of the base model. Such an effect is preferred where
    /// the evidence is equal.
    pub is_base_parameter: bool,
    /// Drives or signals that would separate it from similar effects.
    pub separated_by: &'static str,
}

/// What a search varies besides the amount.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Varies {
    /// Nothing: one amount, with the default parameters.
    Amount,
    /// One amount, if the air temperatures of the drives to fit differ enough. At one temperature
    /// the effect is another coefficient of rolling resistance.
    AmountOverTemperatures {
        /// Smallest range of temperatures, K.
        smallest_range_k: f32,
    },
    /// One amount for each of these values of a parameter. The best value is taken.
    AmountForEachValue {
        /// Key of the parameter.
        key: &'static str,
        /// Values to try.
        values: &'static [f32],
    },
    /// The same, with one amount on the drives that began alike, or with an amount for each drive.
    /// The mean over drives is adopted, not below zero; its sigma includes their scatter.
    AmountForEachDrive {
        /// Key of the parameter.
        key: &'static str,
        /// Values to try.
        values: &'static [f32],
    },
    /// Two amounts, towards north and east, which become a size and a direction.
    NorthAndEast {
        /// Key of the parameter that holds the direction, °.
        key: &'static str,
    },
    /// One amount on each section of the road that the drives share.
    RoadSection {
        /// Key of the latitude of its middle, °.
        latitude_key: &'static str,
        /// Key of the longitude of its middle, °.
        longitude_key: &'static str,
        /// Key of its length, m.
        length_key: &'static str,
    },
    /// The ratio of GNSS speed to wheel speed instead of forces.
    GnssSpeed,
}

impl Effect {
    /// Returns the force that a model without the effect misses in a cell. It is 0 where the inputs
    /// that the effect depends on are not known.
    ///
    /// For effects that scale what the model is given, it is the force to first order, for a sample
    /// made without the effect.
    #[must_use]
    pub fn force(
        &self,
        vehicle: &VehicleParameters,
        sample: &Sample,
        parameters: &ParameterValues,
        amount: f32,
    ) -> Force {
        match self.physics {
            Physics::PerUnit(per_unit_n) => {
                let per_unit_n = finite_or_zero(per_unit_n(vehicle, sample, parameters));
                Force {
                    force_n: finite_or_zero(amount * per_unit_n),
                    per_unit_n,
                }
            }
            Physics::Of(force_n) => {
                // Central difference: exact for forces that are linear or square in the amount.
                let step = 0.5 * self.typical;
                let [less_n, force_n, more_n] = [amount - step, amount, amount + step]
                    .map(|amount| finite_or_zero(force_n(vehicle, sample, parameters, amount)));
                Force {
                    force_n,
                    per_unit_n: (more_n - less_n) / (2.0 * step),
                }
            }
        }
    }

    /// Returns the force of [`force`](Self::force), N.
    #[must_use]
    pub fn force_n(
        &self,
        vehicle: &VehicleParameters,
        sample: &Sample,
        parameters: &ParameterValues,
        amount: f32,
    ) -> f32 {
        self.force(vehicle, sample, parameters, amount).force_n
    }

    /// Returns the derivative of the force with respect to the amount, N per unit.
    #[must_use]
    pub fn derivative_n(
        &self,
        vehicle: &VehicleParameters,
        sample: &Sample,
        parameters: &ParameterValues,
        amount: f32,
    ) -> f32 {
        self.force(vehicle, sample, parameters, amount).per_unit_n
    }

    /// Returns the slope that one unit of the amount reads as where the model lacks it, %.
    #[must_use]
    pub fn slope_percent(
        &self,
        vehicle: &VehicleParameters,
        sample: &Sample,
        parameters: &ParameterValues,
        amount: f32,
    ) -> f32 {
        self.force(vehicle, sample, parameters, amount)
            .slope_percent(sample)
    }
}

impl Force {
    /// Returns the slope that one unit of the amount reads as where the model lacks it, %.
    #[must_use]
    pub fn slope_percent(&self, sample: &Sample) -> f32 {
        100.0 * self.per_unit_n / sample.forces.weight_n()
    }
}

impl Bounds {
    /// Creates the range from `low` to `high`.
    #[must_use]
    pub const fn new(low: f32, high: f32, words: &'static str) -> Self {
        Self { low, high, words }
    }

    /// Returns whether a value lies within.
    #[must_use]
    pub fn holds(self, value: f32) -> bool {
        (self.low..=self.high).contains(&value)
    }

    /// Checks that a value lies within.
    ///
    /// # Errors
    /// The value and the range, if it does not or is not finite.
    pub(crate) fn check(self, key: &'static str, value: f32) -> Result<(), ParameterError> {
        check(key, value, self.low, self.high, self.words)
    }
}

/// Returns a force, or 0 if it is not finite.
fn finite_or_zero(force_n: f32) -> f32 {
    if force_n.is_finite() { force_n } else { 0.0 }
}

/// Compares names: each effect has its own.
impl PartialEq for Effect {
    fn eq(&self, other: &Self) -> bool {
        self.name == other.name
    }
}
