//! What a stop may change: the mass as the vehicle tells it, and all that was learned of the load.

use crate::effect::Acts;
use crate::time::{Duration, Instant};
use crate::tuning::Tuning;
use crate::vehicle::VehicleParameters;

/// Speed below which a vehicle stands, m/s; wheel sensors tell zero from about there.
const STANDING_MPS: f32 = 0.1;
/// Time after a stop in which weighings still belong to it: SPN 1760 has no fixed rate.
const WEIGHING: Duration = Duration::from_millis(30_000);
/// Masses that a vehicle may have, as parts of its parameter.
const MASSES: core::ops::Range<f32> = 0.2..5.0;

/// Standstills and weighings.
///
/// Axle loads sway while driving, loads do not: a mass counts if it is the first, or told at a
/// stop.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Stops {
    newest_speed: Option<Instant>,
    standing_since: Option<Instant>,
    weighing_until: Option<Instant>,
    told_kg: Option<f32>,
    /// The mass at which scale and bias were last as good as unknown.
    learned_kg: Option<f32>,
    was_long: bool,
    /// Time in motion since the start or the last long stop.
    driven: Duration,
}

impl Stops {
    /// Takes a speed.
    pub(super) fn speed(&mut self, tuning: &Tuning, now: Instant, speed_mps: f32) {
        let silent = self
            .newest_speed
            .replace(now)
            .map_or(Duration::default(), |before| now.since(before));
        if silent >= tuning.long_stop {
            // Nobody knows what happened meanwhile; that it stood is the most likely.
            self.was_long = true;
            self.weighing_until = Some(now + WEIGHING);
            self.driven = Duration::default();
        } else if self.standing_since.is_none() {
            self.driven = Duration::from_micros(self.driven.micros() + silent.micros());
        }
        if speed_mps < STANDING_MPS {
            self.standing_since.get_or_insert(now);
        } else if let Some(since) = self.standing_since.take() {
            let stood = now.since(since);
            if stood >= tuning.long_stop {
                self.was_long = true;
                self.driven = Duration::default();
            }
            if stood >= tuning.stop {
                self.weighing_until = Some(now + WEIGHING);
            }
        }
    }

    /// Takes a mass as the vehicle tells it.
    pub(super) fn mass(
        &mut self,
        vehicle: &VehicleParameters,
        tuning: &Tuning,
        now: Instant,
        value: Option<f32>,
    ) {
        let Some(mass_kg) = value.filter(|kg| MASSES.contains(&(kg / vehicle.mass_kg))) else {
            return;
        };
        let stands = self
            .standing_since
            .is_some_and(|since| now.since(since) >= tuning.stop);
        if stands || self.weighing_until.is_some() || self.told_kg.is_none() {
            self.told_kg = Some(mass_kg);
        }
        // Closed by a reading, so that a slow sender has its say too.
        self.weighing_until = self.weighing_until.filter(|until| now < *until);
    }

    /// The mass that counts, kg; the parameter if none was told.
    pub(super) fn mass_kg(&self, vehicle: &VehicleParameters) -> f32 {
        self.told_kg.unwrap_or(vehicle.mass_kg) * vehicle.effects.factor(Acts::Mass)
    }

    /// Time in motion since the start or the last long stop, s. Tyres cool down in such a stop, not
    /// in one that only changes the load.
    pub(super) fn driven_s(&self) -> f32 {
        // Days, unlike other spans.
        self.driven.micros() as f32 * 1e-6
    }

    /// Whether a stop since the last call may have undone what was learned of the vehicle.
    pub(super) fn take_reopening(&mut self, vehicle: &VehicleParameters, tuning: &Tuning) -> bool {
        let mass_kg = self.mass_kg(vehicle);
        let learned_kg = *self.learned_kg.get_or_insert(mass_kg);
        let reloaded = (mass_kg / learned_kg - 1.0).abs() >= tuning.mass_change;
        let reopens = core::mem::take(&mut self.was_long) || reloaded;
        if reopens {
            self.learned_kg = Some(mass_kg);
        }
        reopens
    }
}
