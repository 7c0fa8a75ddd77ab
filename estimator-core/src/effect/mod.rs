//! What the force balance of the thesis (eq. 9) lacks: one file an effect.
//!
//! An effect is a resisting force, or a scale factor on what the model is given. Its size is one
//! number with a unit, the amount. The effect says which force a model misses that does not have it.
//! A positive amount resists: without the effect the road reads as steeper than it is. Only
//! [`torque_scale`] has the opposite sign, as more torque drives.
//!
//! A vehicle adopts effects with amounts and their uncertainty
//! ([`Model`](crate::model::Model)); the estimator then includes them.
//!
//! # How to add an effect
//!
//! Write its file in this folder and its line in the list below. Vehicle files, their checks, the
//! filter's covariance, the persistent state and the search of the diagnosis know it from then on.
//! An example: roads are wet just above freezing, which adds to the rolling resistance. The file
//! `wet_road.rs`:
//!
//! ```
//! use estimator_core::effect::{Acts, Bounds, Description, Effect, Physics, Search, Varies};
//! // in the folder: use super::definition::{…}
//!
//! /// F = a m g between 0 and 5 °C.
//! pub static EFFECT: Effect = Effect {
//!     number: 200, // the next free one; it never changes
//!     name: "wet_road",
//!     unit: "1",
//!     typical: 0.001,
//!     range: Bounds::new(0.0, 0.01, "0 to 0.01"),
//!     parameters: &[],
//!     acts: Acts::Resists,
//!     physics: Physics::PerUnit(|_vehicle, sample, _parameters| {
//!         let Some(celsius) = sample.effect_inputs.ambient_celsius.get() else {
//!             return 0.0;
//!         };
//!         if (0.0..=5.0).contains(&celsius) {
//!             sample.forces.weight_n()
//!         } else {
//!             0.0
//!         }
//!     }),
//! };
//!
//! /// Its physics and their source.
//! pub static DESCRIPTION: Description = Description {
//!     about: "Near freezing roads are wet: the coefficient of rolling resistance is larger by the amount.",
//!     source: "wet roads add 10 to 20 % of it",
//! };
//!
//! /// How a search varies it.
//! pub static SEARCH: Search = Search {
//!     varies: Varies::Amount,
//!     is_base_parameter: false,
//!     separated_by: "drives in other weather",
//! };
//! ```
//!
//! and its line, `wet_road,`. A vehicle file may then have `[effects.wet_road]` with `amount` and
//! `amount_sigma`.

pub mod definition;

pub use definition::{
    Acts, Bounds, Description, Effect, EffectParameter, Force, MAX_EFFECT_PARAMETERS,
    ParameterValues, Physics, Search, Varies,
};

macro_rules! catalogue {
    ($($name:ident,)*) => {
        $(pub mod $name;)*

        /// Number of effects.
        pub const MAX_EFFECTS: usize = [$(stringify!($name)),*].len();

        /// Every effect.
        pub static CATALOGUE: [&Effect; MAX_EFFECTS] = [$(&$name::EFFECT),*];

        /// What each effect is, in the order of [`CATALOGUE`].
        static DESCRIPTIONS: [&Description; MAX_EFFECTS] = [$(&$name::DESCRIPTION),*];

        /// How a search varies each effect, in the order of [`CATALOGUE`].
        static SEARCHES: [&Search; MAX_EFFECTS] = [$(&$name::SEARCH),*];
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
    tyre_temperature,
}

/// Returns the effect of this name.
#[must_use]
pub fn named(name: &str) -> Option<&'static Effect> {
    CATALOGUE.into_iter().find(|effect| effect.name == name)
}

/// Returns the effect that stored data call by this number ([`Effect::number`]). `None` if this
/// release has no such effect: data that contain it must be refused.
#[must_use]
pub fn numbered(number: u32) -> Option<&'static Effect> {
    CATALOGUE
        .into_iter()
        .find(|effect| u32::from(effect.number) == number)
}

/// Returns what an effect is, in words; `None` for one outside the catalogue.
#[must_use]
pub fn description_of(effect: &Effect) -> Option<&'static Description> {
    beside(effect, DESCRIPTIONS)
}

/// Returns how the diagnosis on a host searches for an effect; `None` for one outside the catalogue.
#[must_use]
pub fn search_of(effect: &Effect) -> Option<&'static Search> {
    beside(effect, SEARCHES)
}

fn beside<T>(effect: &Effect, list: [&'static T; MAX_EFFECTS]) -> Option<&'static T> {
    let mut pairs = CATALOGUE.into_iter().zip(list);
    let found = pairs.find(|(known, _)| *known == effect);
    found.map(|(_, one)| one)
}
