//! The effects that a vehicle is believed to have.

use super::{Acts, Bounds, Details, Effect, Force, MAX_DETAILS, MAX_EFFECTS};
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
#[derive(Clone, Debug, PartialEq)]
pub struct Effects {
    /// In the order of their names: sums do not depend on which came first.
    adopted: Vec<Adopted, MAX_EFFECTS>,
    // What follows from them, and is asked for with every reading.
    mass: f32,
    traction: f32,
    wheel_radius: f32,
}

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

    /// [`Effect::force`] of its amount.
    #[must_use]
    pub fn force(&self, vehicle: &VehicleParameters, sample: &Sample) -> Force {
        self.effect
            .force(vehicle, sample, &self.details, self.amount)
    }

    /// [`Effect::force_n`] of its amount.
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
        self.insert(adopted)?;
        let factor = |acts| -> f32 {
            self.acting(acts)
                .map(|adopted| 1.0 + adopted.amount)
                .product()
        };
        let factors = [Acts::Mass, Acts::Traction, Acts::WheelRadius].map(factor);
        [self.mass, self.traction, self.wheel_radius] = factors;
        Ok(())
    }

    fn insert(&mut self, mut adopted: Adopted) -> Result<(), Adopted> {
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

    /// Those adopted, by name.
    pub fn iter(&self) -> impl Iterator<Item = &Adopted> {
        self.adopted.iter()
    }

    /// Whether there is none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.adopted.is_empty()
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
    pub const fn factor(&self, acts: Acts) -> f32 {
        match acts {
            Acts::Resists => 1.0,
            Acts::Mass => self.mass,
            Acts::Traction => self.traction,
            Acts::WheelRadius => self.wheel_radius,
        }
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

impl Default for Effects {
    /// None.
    fn default() -> Self {
        Self {
            adopted: Vec::new(),
            mass: 1.0,
            traction: 1.0,
            wheel_radius: 1.0,
        }
    }
}
