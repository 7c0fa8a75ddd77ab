//! The effects that a vehicle is believed to have.

use super::{Acts, Bounds, Details, Effect, MAX_DETAILS, MAX_EFFECTS};
use crate::maybe::Maybe;
use crate::sampler::Sample;
use crate::vehicle::{ParameterError, VehicleParameters, check};
use core::mem;
use heapless::Vec;

/// An effect with its amount.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Adopted {
    /// Which one.
    pub effect: &'static Effect,
    /// How much of it, in its unit.
    pub amount: f32,
    /// Standard deviation of the amount.
    pub amount_sigma: f32,
    /// Its details.
    pub details: Details,
}

/// Effects, each at most once.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Effects(Vec<Adopted, MAX_EFFECTS>);

impl Adopted {
    /// An effect with the usual details.
    #[must_use]
    pub fn new(effect: &'static Effect, amount: f32, amount_sigma: f32) -> Self {
        let mut details = [Maybe::NONE; MAX_DETAILS];
        for (value, detail) in details.iter_mut().zip(effect.details) {
            *value = detail.default;
        }
        Self {
            effect,
            amount,
            amount_sigma,
            details,
        }
    }

    /// Sets a detail. False if the effect has none of this key.
    #[must_use]
    pub fn set(&mut self, key: &str, value: f32) -> bool {
        let mut details = self.details.iter_mut().zip(self.effect.details);
        let found = details.find(|(_, detail)| detail.key == key);
        found
            .map(|(place, _)| *place = Maybe::some(value))
            .is_some()
    }

    /// The details that are given, by their keys.
    pub fn given(&self) -> impl Iterator<Item = (&'static str, f32)> + '_ {
        let details = self.effect.details.iter().zip(&self.details);
        details.filter_map(|(detail, value)| Some((detail.key, value.get()?)))
    }

    /// [`Effect::force_n`] of its amount.
    #[must_use]
    pub fn force_n(&self, vehicle: &VehicleParameters, sample: &Sample) -> f32 {
        self.effect
            .force_n(vehicle, sample, &self.details, self.amount)
    }

    /// What its uncertainty makes of the slope in a cell, 1 sigma with the sign of the force, %.
    #[must_use]
    pub fn slope_sigma_percent(&self, vehicle: &VehicleParameters, sample: &Sample) -> f32 {
        let slope = self
            .effect
            .slope_percent(vehicle, sample, &self.details, self.amount);
        self.amount_sigma * slope
    }

    fn check(&self) -> Result<(), ParameterError> {
        let Bounds { low, high, .. } = self.effect.range;
        self.effect.range.check("amount", self.amount)?;
        check(
            "amount_sigma",
            self.amount_sigma,
            0.0,
            high - low,
            "not below 0, nor beyond what amounts can be",
        )?;
        for (detail, value) in self.effect.details.iter().zip(self.details) {
            if let Some(value) = value.get() {
                detail.range.check(detail.key, value)?;
            }
        }
        Ok(())
    }
}

impl Effects {
    /// Adopts an effect, in place of what was adopted of the same.
    ///
    /// # Errors
    /// Gives it back if there is no room: only for effects that the catalogue does not have.
    pub fn adopt(&mut self, adopted: Adopted) -> Result<(), Adopted> {
        let mut known = self.0.iter_mut();
        if let Some(same) = known.find(|other| other.effect == adopted.effect) {
            *same = adopted;
            return Ok(());
        }
        if self.0.is_full() {
            return Err(adopted);
        }
        // In the order of their names: sums do not depend on which came first.
        let mut adopted = adopted;
        for other in &mut self.0 {
            if other.effect.name > adopted.effect.name {
                mem::swap(other, &mut adopted);
            }
        }
        self.0.push(adopted)
    }

    /// Those adopted, by name.
    pub fn iter(&self) -> impl Iterator<Item = &Adopted> {
        self.0.iter()
    }

    /// Whether there is none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// Force in N that resists in a cell besides what the base model has. Effects that scale what
    /// the model is told are in the sample already.
    #[must_use]
    pub fn force_n(&self, vehicle: &VehicleParameters, sample: &Sample) -> f32 {
        self.acting(Acts::Resists)
            .map(|adopted| adopted.force_n(vehicle, sample))
            .sum()
    }

    /// What a quantity of the model is to be multiplied with.
    #[must_use]
    #[inline(never)] // One copy for all the places that ask: flash is dear.
    pub fn factor(&self, acts: Acts) -> f32 {
        self.acting(acts)
            .map(|adopted| 1.0 + adopted.amount)
            .product()
    }

    /// Those that enter the model there.
    fn acting(&self, acts: Acts) -> impl Iterator<Item = &Adopted> {
        self.iter()
            .filter(move |adopted| adopted.effect.acts == acts)
    }

    pub(crate) fn check(&self) -> Result<(), ParameterError> {
        self.iter().try_for_each(|adopted| {
            adopted
                .check()
                .map_err(|error| error.of_effect(adopted.effect.name))
        })
    }
}
