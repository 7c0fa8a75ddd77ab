//! The effects that a vehicle model includes.

use crate::effect::{
    Acts, Bounds, Effect, Force, MAX_EFFECT_PARAMETERS, MAX_EFFECTS, ParameterValues,
};
use crate::maybe::Maybe;
use crate::sample::Sample;
use crate::vehicle::VehicleParameters;
use crate::vehicle::parameter_check::{ParameterError, check};
use core::mem;
use heapless::Vec;

/// An effect with its amount and its uncertainty.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AdoptedEffect {
    /// The effect.
    pub effect: &'static Effect,
    /// Its amount, in the effect's unit.
    pub amount: f32,
    /// Standard deviation of the amount, in the effect's unit.
    pub amount_sigma: f32,
    /// Its parameters, in the order of [`Effect::parameters`].
    pub parameters: ParameterValues,
}

/// Adopted effects, each at most once.
#[derive(Clone, Debug, PartialEq)]
pub struct AdoptedEffects {
    /// Sorted by name, so that sums do not depend on the order of adoption.
    adopted: Vec<AdoptedEffect, MAX_EFFECTS>,
    // Scale factors that follow from them. They are needed with every reading.
    mass: f32,
    traction: f32,
    wheel_radius: f32,
    /// Variance of the factor on the mass, as a part of it.
    mass_variance: f32,
}

impl AdoptedEffect {
    /// Creates an adopted effect with default parameters.
    #[must_use]
    pub fn new(effect: &'static Effect, amount: f32, amount_sigma: f32) -> Self {
        let mut parameters = [Maybe::NONE; MAX_EFFECT_PARAMETERS];
        for (value, parameter) in parameters.iter_mut().zip(effect.parameters) {
            *value = parameter.default;
        }
        Self {
            effect,
            amount,
            amount_sigma,
            parameters,
        }
    }

    /// Sets a parameter. Returns false if the effect has none of this key.
    #[must_use]
    pub fn set(&mut self, key: &str, value: f32) -> bool {
        let mut parameters = self.parameters.iter_mut().zip(self.effect.parameters);
        let found = parameters.find(|(_, parameter)| parameter.key == key);
        found.map(|(slot, _)| *slot = Maybe::some(value)).is_some()
    }

    /// Returns the parameters that have a value, by key.
    pub fn given_parameters(&self) -> impl Iterator<Item = (&'static str, f32)> + '_ {
        let parameters = self.effect.parameters.iter().zip(&self.parameters);
        parameters.filter_map(|(parameter, value)| Some((parameter.key, value.get()?)))
    }

    /// Returns [`Effect::force`] of its amount.
    #[inline(never)] // Called from several places.
    #[must_use]
    pub fn force(&self, vehicle: &VehicleParameters, sample: &Sample) -> Force {
        self.effect
            .force(vehicle, sample, &self.parameters, self.amount)
    }

    /// Returns [`Effect::force_n`] of its amount.
    #[must_use]
    pub fn force_n(&self, vehicle: &VehicleParameters, sample: &Sample) -> f32 {
        self.force(vehicle, sample).force_n
    }

    fn check(&self) -> Result<(), ParameterError> {
        let Bounds { low, high, .. } = self.effect.range;
        self.effect.range.check("amount", self.amount)?;
        check(
            "amount_sigma",
            self.amount_sigma,
            0.0,
            high - low,
            "from 0 to the width of the range of amounts",
        )?;
        for (parameter, value) in self.effect.parameters.iter().zip(self.parameters) {
            if let Some(value) = value.get() {
                parameter.range.check(parameter.key, value)?;
            }
        }
        Ok(())
    }
}

impl AdoptedEffects {
    /// Adopts an effect. It replaces an adopted one of the same name.
    ///
    /// # Errors
    /// Returns the effect if there is no room, which is so only for effects outside the catalogue.
    pub fn adopt(&mut self, adopted: AdoptedEffect) -> Result<(), AdoptedEffect> {
        self.insert(adopted)?;
        self.multiply();
        Ok(())
    }

    /// Computes the scale factors.
    fn multiply(&mut self) {
        let [mut mass, mut traction, mut wheel_radius] = [1.0; 3];
        let mut mass_variance = 0.0;
        for adopted in &self.adopted {
            let factor = 1.0 + adopted.amount;
            match adopted.effect.acts {
                Acts::Resists => {}
                Acts::Mass => {
                    let part = adopted.amount_sigma / factor;
                    mass *= factor;
                    mass_variance += part * part;
                }
                Acts::Traction => traction *= factor,
                Acts::WheelRadius => wheel_radius *= factor,
            }
        }
        self.mass = mass;
        self.traction = traction;
        self.wheel_radius = wheel_radius;
        self.mass_variance = mass_variance;
    }

    fn insert(&mut self, mut adopted: AdoptedEffect) -> Result<(), AdoptedEffect> {
        let mut known = self.adopted.iter_mut();
        if let Some(same) = known.find(|other| other.effect == adopted.effect) {
            *same = adopted;
            return Ok(());
        }
        if self.adopted.is_full() {
            return Err(adopted);
        }
        for other in &mut self.adopted {
            if other.effect.name > adopted.effect.name {
                mem::swap(other, &mut adopted);
            }
        }
        self.adopted.push(adopted)
    }

    /// Returns the adopted effects, sorted by name.
    pub fn iter(&self) -> impl Iterator<Item = &AdoptedEffect> {
        self.adopted.iter()
    }

    /// Returns whether no effect is adopted.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.adopted.is_empty()
    }

    /// Returns the resisting force in a cell besides that of the base model, N. Effects that scale
    /// what the model is given are already part of the sample.
    #[must_use]
    pub fn force_n(&self, vehicle: &VehicleParameters, sample: &Sample) -> f32 {
        self.acting(Acts::Resists)
            .map(|adopted| adopted.force_n(vehicle, sample))
            .sum()
    }

    /// Returns the scale factor on a quantity of the model.
    #[must_use]
    pub const fn factor(&self, acts: Acts) -> f32 {
        match acts {
            Acts::Resists => 1.0,
            Acts::Mass => self.mass,
            Acts::Traction => self.traction,
            Acts::WheelRadius => self.wheel_radius,
        }
    }

    /// Returns the variance of the scale factor on the mass, as a part of it; 0 without a sigma.
    #[must_use]
    pub(crate) const fn mass_variance(&self) -> f32 {
        self.mass_variance
    }

    /// Returns the effects that enter the model there.
    fn acting(&self, acts: Acts) -> impl Iterator<Item = &AdoptedEffect> {
        self.iter()
            .filter(move |adopted| adopted.effect.acts == acts)
    }

    /// Checks every amount and parameter.
    ///
    /// # Errors
    /// The first one outside its range, with the name of its effect.
    pub(crate) fn check(&self) -> Result<(), ParameterError> {
        self.iter().try_for_each(|adopted| {
            adopted
                .check()
                .map_err(|error| error.of_effect(adopted.effect.name))
        })
    }
}

impl Default for AdoptedEffects {
    /// Creates the set without effects.
    fn default() -> Self {
        Self {
            adopted: Vec::new(),
            mass: 1.0,
            traction: 1.0,
            wheel_radius: 1.0,
            mass_variance: 0.0,
        }
    }
}
