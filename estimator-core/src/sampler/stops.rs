//! Stops, and what they may change: the reported mass, and all that was learned of the load.

use super::latest::TimedValue;
use crate::context::Context;
use crate::effect::Acts;
use crate::model::Model;
use crate::scalar::Scalar;
use crate::time::{Duration, Instant};
use crate::tuning::Tuning;

/// Standstills and weighings.
///
/// Reported axle loads vary while driving, loads do not. A mass counts if it is the first one, or is
/// reported at a stop.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Stops {
    newest_speed: Option<Instant>,
    standing_since: Option<Instant>,
    weighing_until: Option<Instant>,
    reported_kg: Option<f32>,
    /// Mass at which the variances of scale and bias were last widened.
    learned_kg: Option<f32>,
    was_long: bool,
    /// It was long enough to be loaded, and nothing reported the mass.
    was_stop: bool,
    /// Time in motion since the start or the last long stop.
    driven: Duration,
}

impl Stops {
    /// Takes a speed.
    pub(super) fn speed(&mut self, tuning: &Tuning, speed: TimedValue) {
        let hold_times = &tuning.hold_times;
        let now = speed.time;
        let silence = self
            .newest_speed
            .replace(now)
            .map_or(Duration::default(), |before| now.since(before));
        if silence >= hold_times.long_stop {
            // It is most likely that the vehicle stood.
            self.was_long = true;
            self.weighing_until = Some(now + hold_times.load_stop);
            self.driven = Duration::default();
        } else if self.standing_since.is_none() {
            self.driven = Duration::from_micros(self.driven.micros() + silence.micros());
        }
        if speed.value < tuning.detection.standing_mps {
            self.standing_since.get_or_insert(now);
        } else if let Some(since) = self.standing_since.take() {
            let stood = now.since(since);
            if stood >= hold_times.long_stop {
                self.was_long = true;
                self.driven = Duration::default();
            }
            if stood >= hold_times.stop {
                self.weighing_until = Some(now + hold_times.load_stop);
            }
            if stood >= hold_times.load_stop {
                self.was_stop = true;
            }
        }
    }

    /// Takes a reported mass.
    #[inline(never)] // See Sampler::record().
    pub(super) fn mass(&mut self, context: &Context, now: Instant, value: Option<f32>) {
        let detection = &context.tuning.detection;
        let parameter_kg = context.model.vehicle.mass_kg;
        let is_possible = |kg: &f32| {
            let least_kg = Scalar::min(*kg, parameter_kg);
            *kg > 0.0 && Scalar::max(*kg, parameter_kg) <= detection.mass_range * least_kg
        };
        let Some(mass_kg) = value.filter(is_possible) else {
            return;
        };
        let stands = self
            .standing_since
            .is_some_and(|since| now.since(since) >= context.tuning.hold_times.stop);
        if stands || self.weighing_until.is_some() || self.reported_kg.is_none() {
            self.reported_kg = Some(mass_kg);
        }
        // A reading ends the weighing, so that a slow sender counts too.
        self.weighing_until = self.weighing_until.filter(|until| now < *until);
    }

    /// Returns the mass that counts, kg: the reported one, else the parameter.
    pub(super) fn mass_kg(&self, model: &Model) -> f32 {
        self.reported_kg.unwrap_or(model.vehicle.mass_kg) * model.effects.factor(Acts::Mass)
    }

    /// Returns whether that mass is a reported one.
    pub(super) const fn has_reported_mass(&self) -> bool {
        self.reported_kg.is_some()
    }

    /// Returns the time in motion since the start or the last long stop, s. Tyres cool down in a
    /// long stop, not in one that only changes the load.
    pub(super) fn driven_s(&self) -> f32 {
        // It may be days, unlike other durations.
        self.driven.micros() as f32 * 1e-6
    }

    /// Takes a change of the traction that the model computes: it reads as another load.
    pub(super) const fn scale_changed(&mut self) {
        self.was_long = true;
    }

    /// Returns whether there was a stop since the last call in which the load may have changed.
    pub(super) fn take_stop(&mut self) -> bool {
        core::mem::take(&mut self.was_stop)
    }

    /// Returns whether a stop since the last call may have changed the load.
    pub(super) fn take_load_change(&mut self, context: &Context) -> bool {
        let mass_kg = self.mass_kg(&context.model);
        let learned_kg = *self.learned_kg.get_or_insert(mass_kg);
        let change = (mass_kg / learned_kg - 1.0).abs();
        let is_reloaded = change >= context.tuning.detection.mass_change;
        let may_have_changed = core::mem::take(&mut self.was_long) || is_reloaded;
        if may_have_changed {
            self.learned_kg = Some(mass_kg);
        }
        may_have_changed
    }
}
