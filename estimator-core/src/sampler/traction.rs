//! Torque, gears and forces become the mean traction force of an interval.

use super::latest::{Latest, Timed};
use crate::signal::Signal;
use crate::time::{Duration, Instant};
use crate::vehicle::{Driveline, Traction, VehicleParameters};

/// A torque older than this says nothing about the force now.
pub(super) const STALE: Duration = Duration::from_millis(2_500);

/// What is known of the force at the wheels.
#[derive(Clone, Debug)]
pub(super) struct TractionInput {
    fraction: Latest,
    torque: Latest,
    friction: Latest,
    force: Latest,
    driveline: Driveline,
    driveline_was_known: bool,
    integral: ForceIntegral,
}

impl TractionInput {
    pub(super) fn new() -> Self {
        Self {
            fraction: Latest::default(),
            torque: Latest::default(),
            friction: Latest::default(),
            force: Latest::default(),
            driveline: Driveline::Unknown,
            driveline_was_known: false,
            integral: ForceIntegral::default(),
        }
    }

    /// Takes a reading; true if it told the force.
    #[inline(always)] // In Sampler::record.
    pub(super) fn record(
        &mut self,
        vehicle: &VehicleParameters,
        now: Instant,
        signal: Signal,
        value: Option<f32>,
    ) -> bool {
        match signal {
            Signal::EngineTorqueFraction => self.fraction.set(value, now),
            // It follows the engine's speed and warmth: what was told last is nearer than none.
            Signal::FrictionTorque => self.friction.keep(value, now),
            Signal::EngineTorque => {
                self.torque.set(value, now);
                return self.torque_changed(vehicle, now);
            }
            Signal::TractionForce => {
                self.force.set(value, now);
                if let (Some(force_n), Traction::Force) = (value, &vehicle.traction) {
                    self.integral.reading(force_n, now);
                    return true;
                }
            }
            _ => {}
        }
        false
    }

    /// The driveline is now as told. True if it opened, closed or changed gear.
    pub(super) fn driveline_is(
        &mut self,
        vehicle: &VehicleParameters,
        now: Instant,
        driveline: Driveline,
    ) -> bool {
        if driveline == self.driveline {
            return false;
        }
        // What is told for the first time did not just happen.
        let is_step = self.driveline_was_known && !driveline.is_nearly(&self.driveline);
        self.driveline_was_known = true;
        self.driveline = driveline;
        if let Some(net_percent) = self.net_torque_percent(now) {
            self.integral
                .step_to(vehicle.traction_n(driveline, net_percent), now);
        }
        is_step
    }

    /// Whether the force is known now.
    pub(super) fn is_known(&self, vehicle: &VehicleParameters, now: Instant) -> bool {
        match (&vehicle.traction, self.driveline) {
            (Traction::Force, _) => self.force.within(now, STALE).is_some(),
            (Traction::Powertrain(_), Driveline::Open) => true,
            (Traction::Powertrain(_), Driveline::Engaged(_)) => {
                self.torque.within(now, STALE).is_some()
            }
            (Traction::Powertrain(_), Driveline::Unknown) => false,
        }
    }

    /// Whether the driveline passes torque now; a measured force always arrives.
    pub(super) fn arrives(&self, vehicle: &VehicleParameters) -> bool {
        match vehicle.traction {
            Traction::Force => true,
            Traction::Powertrain(_) => matches!(self.driveline, Driveline::Engaged(_)),
        }
    }

    /// Mean force since the last call, N.
    pub(super) fn take_mean_n(&mut self, now: Instant) -> f32 {
        self.integral.take_mean(now)
    }

    /// Mass that rotating parts add now, kg.
    pub(super) fn rotating_kg(&self, vehicle: &VehicleParameters) -> f32 {
        vehicle.rotating_kg(self.driveline)
    }

    fn torque_changed(&mut self, vehicle: &VehicleParameters, now: Instant) -> bool {
        if vehicle.traction == Traction::Force {
            return false;
        }
        let Some(net_percent) = self.net_torque_percent(now) else {
            return false;
        };
        self.integral
            .reading(vehicle.traction_n(self.driveline, net_percent), now);
        self.driveline != Driveline::Unknown
    }

    /// SPN 513 + 4154 − 514: 513 is indicated torque and holds what friction takes.
    pub(super) fn net_torque_percent(&self, now: Instant) -> Option<f32> {
        let torque = self.torque.within(now, STALE)?;
        let fraction = self.fraction.within(now, STALE).unwrap_or(0.0);
        let friction = self.friction.last().unwrap_or(0.0);
        Some(torque + fraction - friction)
    }
}

/// Force over time since the last speed reading.
#[derive(Clone, Copy, Debug, Default)]
struct ForceIntegral {
    newton_seconds: f32,
    seconds: f32,
    last: Option<Timed>,
}

impl ForceIntegral {
    /// A new reading of the force: linear from the last one.
    fn reading(&mut self, force_n: f32, now: Instant) {
        let from_n = self.last.map_or(force_n, |last| last.value);
        self.extend(0.5 * (from_n + force_n), now);
        self.last = Some(Timed {
            value: force_n,
            time: now,
        });
    }

    /// The force changes at once (a gear, a clutch): what was, held until now, then the new one.
    fn step_to(&mut self, force_n: f32, now: Instant) {
        self.hold(now);
        self.last = Some(Timed {
            value: force_n,
            time: now,
        });
    }

    fn hold(&mut self, now: Instant) {
        if let Some(last) = self.last {
            self.extend(last.value, now);
            self.last = Some(Timed {
                value: last.value,
                time: now,
            });
        }
    }

    fn extend(&mut self, mean_n: f32, now: Instant) {
        if let Some(last) = self.last {
            let seconds = now.since(last.time).seconds();
            self.newton_seconds += mean_n * seconds;
            self.seconds += seconds;
        }
    }

    fn take_mean(&mut self, now: Instant) -> f32 {
        self.hold(now);
        let mean = if self.seconds > 0.0 {
            self.newton_seconds / self.seconds
        } else {
            self.last.map_or(0.0, |last| last.value)
        };
        self.newton_seconds = 0.0;
        self.seconds = 0.0;
        mean
    }
}
