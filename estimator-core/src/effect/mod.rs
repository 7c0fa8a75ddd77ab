//! What the force balance of the thesis (eq. 9) lacks: one file an effect.
//!
//! An effect is a force that resists, or a scale of what the model is told. Each has one number,
//! its amount, with a unit, and says what force a model misses that does not have it. A positive
//! amount resists: without the effect the road reads as steeper than it is (only
//! [`torque_scale`] is the other way round, as more torque drives).
//!
//! A vehicle adopts effects with amounts and their uncertainty ([`VehicleParameters::effects`]);
//! the estimator then counts with them.
//!
//! # Another effect
//!
//! It takes its file in this folder and its line in the list below; vehicle files, `check`, the
//! filter's covariance and what is kept between drives know it from then on. Say that roads are wet
//! just above freezing, and that this adds to the rolling resistance. The file,
//! `wet_road.rs`:
//!
//! ```
//! # use estimator_core::vehicle::GRAVITY;
//! use estimator_core::effect::{Acts, Bounds, Effect, Physics}; // in the folder: use super::{…}
//!
//! /// F = a m g between 0 and 5 °C.
//! pub static EFFECT: Effect = Effect {
//!     name: "wet_road",
//!     unit: "1",
//!     about: "Near freezing roads are wet: the coefficient of rolling resistance is larger by the amount.",
//!     source: "wet roads add 10 to 20 % of it",
//!     typical: 0.001,
//!     range: Bounds::new(0.0, 0.01, "0 to 0.01"),
//!     details: &[],
//!     acts: Acts::Resists,
//!     physics: Physics::PerUnit(|_vehicle, sample, _details| {
//!         let Some(celsius) = sample.circumstances.ambient_celsius.get() else {
//!             return 0.0;
//!         };
//!         if (0.0..=5.0).contains(&celsius) {
//!             sample.load.mass_kg * GRAVITY
//!         } else {
//!             0.0
//!         }
//!     }),
//! };
//! ```
//!
//! and its line, `wet_road,`. A vehicle file may then have `[effects.wet_road]` with `amount` and
//! `amount_sigma`.

mod adopted;
mod details;

pub use adopted::{Adopted, Effects};
pub use details::{Bounds, Detail, Details, MAX_DETAILS};

use crate::sampler::Sample;
use crate::vehicle::{GRAVITY, VehicleParameters};

macro_rules! catalogue {
    ($($name:ident,)*) => {
        $(pub mod $name;)*

        /// Number of effects that there are.
        pub const MAX_EFFECTS: usize = [$(stringify!($name)),*].len();

        /// Every effect.
        pub static CATALOGUE: [&Effect; MAX_EFFECTS] = [$(&$name::EFFECT),*];
    };
}

catalogue! {
    rolling_resistance,
    tyre_warmup,
    air_drag,
    headwind,
    cornering,
    driveline_loss,
    auxiliary_load,
    mass,
    torque_scale,
    wheel_radius,
    brake_drag,
    road_surface,
}

/// Something that the base model lacks.
#[derive(Debug)]
pub struct Effect {
    /// Its name, in vehicle files and reports.
    pub name: &'static str,
    /// Unit of the amount; "1" if it has none.
    pub unit: &'static str,
    /// Its physics in a sentence.
    pub about: &'static str,
    /// Where that and the usual amounts come from.
    pub source: &'static str,
    /// 1 sigma of the amounts that vehicles and roads have.
    pub typical: f32,
    /// Amounts that can be.
    pub range: Bounds,
    /// What else it depends on besides its amount.
    pub details: &'static [Detail],
    /// Where it enters the model.
    pub acts: Acts,
    /// What [`force`](Self::force) is.
    pub physics: Physics,
}

/// Force that the model misses in a cell without an effect of some amount.
#[derive(Clone, Copy, Debug)]
pub enum Physics {
    /// In proportion to the amount: N per unit of it.
    PerUnit(fn(&VehicleParameters, &Sample, &Details) -> f32),
    /// In any other way: N for an amount.
    Of(fn(&VehicleParameters, &Sample, &Details, f32) -> f32),
}

/// What an effect does in a cell.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Force {
    /// The force, positive if it resists, N.
    pub force_n: f32,
    /// Its change with the amount, N per unit of it.
    pub per_unit_n: f32,
}

/// Where an effect enters the model.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Acts {
    /// As a force that resists.
    Resists,
    /// The mass is larger by the amount, the parameter and what is told on the bus.
    Mass,
    /// The traction force is larger by the amount, whatever tells it.
    Traction,
    /// The wheels are larger by the amount: so are speed and distance, and the force of a torque is
    /// smaller.
    WheelRadius,
}

impl Effect {
    /// The effect of this name.
    #[must_use]
    pub fn named(name: &str) -> Option<&'static Self> {
        CATALOGUE.into_iter().find(|effect| effect.name == name)
    }

    /// What a model without it misses in a cell; nothing where the circumstances that it depends on
    /// are not known.
    ///
    /// For effects that scale what the model is told, to first order, for a sample made without.
    #[must_use]
    pub fn force(
        &self,
        vehicle: &VehicleParameters,
        sample: &Sample,
        details: &Details,
        amount: f32,
    ) -> Force {
        match self.physics {
            Physics::PerUnit(per_unit_n) => {
                let per_unit_n = or_none(per_unit_n(vehicle, sample, details));
                Force {
                    force_n: or_none(amount * per_unit_n),
                    per_unit_n,
                }
            }
            Physics::Of(force_n) => {
                // Central: exact for forces that are linear or square in the amount.
                let step = 0.5 * self.typical;
                let [less_n, force_n, more_n] = [amount - step, amount, amount + step]
                    .map(|amount| or_none(force_n(vehicle, sample, details, amount)));
                Force {
                    force_n,
                    per_unit_n: (more_n - less_n) / (2.0 * step),
                }
            }
        }
    }

    /// The force of [`force`](Self::force), N.
    #[must_use]
    pub fn force_n(
        &self,
        vehicle: &VehicleParameters,
        sample: &Sample,
        details: &Details,
        amount: f32,
    ) -> f32 {
        self.force(vehicle, sample, details, amount).force_n
    }

    /// Its change with the amount, N per unit of it.
    #[must_use]
    pub fn derivative_n(
        &self,
        vehicle: &VehicleParameters,
        sample: &Sample,
        details: &Details,
        amount: f32,
    ) -> f32 {
        self.force(vehicle, sample, details, amount).per_unit_n
    }

    /// The slope that one unit of the amount reads as where the model lacks it, %.
    #[must_use]
    pub fn slope_percent(
        &self,
        vehicle: &VehicleParameters,
        sample: &Sample,
        details: &Details,
        amount: f32,
    ) -> f32 {
        self.force(vehicle, sample, details, amount)
            .slope_percent(sample)
    }
}

impl Force {
    /// The slope that one unit of the amount reads as where the model lacks it, %.
    #[must_use]
    pub fn slope_percent(&self, sample: &Sample) -> f32 {
        100.0 * self.per_unit_n / weight_n(sample)
    }
}

/// A force; none if it is no number.
fn or_none(force_n: f32) -> f32 {
    if force_n.is_finite() { force_n } else { 0.0 }
}

/// Effects are told apart by their names.
impl PartialEq for Effect {
    fn eq(&self, other: &Self) -> bool {
        self.name == other.name
    }
}

/// Weight, N.
fn weight_n(sample: &Sample) -> f32 {
    sample.load.mass_kg * GRAVITY
}

/// Air resistance as the base model has it (thesis eq. 5), N.
fn base_drag_n(vehicle: &VehicleParameters, sample: &Sample) -> f32 {
    drag_n(vehicle.drag_area_m2, sample, sample.place.speed_mps)
}

/// Air resistance of an area in air that comes at a speed; air from behind pushes, N.
fn drag_n(area_m2: f32, sample: &Sample, air_mps: f32) -> f32 {
    0.5 * area_m2 * sample.load.air_density * air_mps * air_mps.abs()
}
