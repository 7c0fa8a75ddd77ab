//! Torque, gears and forces become the mean traction force of an interval.

use super::latest::{Latest, Timed};
use crate::signal::Signal;
use crate::time::{Duration, Instant};
use crate::vehicle::{Driveline, Powertrain, Traction, VehicleParameters};

/// A torque older than this says nothing about the force now.
const STALE: Duration = Duration::from_millis(2_500);

/// What is known of the driveline and of the force at the wheels.
#[derive(Clone, Debug)]
pub(super) struct TractionInput {
    fraction: Latest,
    torque: Latest,
    friction: Latest,
    engine_speed: Latest,
    force: Latest,
    engaged: Latest,
    gear_ratio: Latest,
    gear: Latest,
    driveline: Driveline,
    integral: ForceIntegral,
}

impl TractionInput {
    pub(super) fn new() -> Self {
        Self {
            fraction: Latest::default(),
            torque: Latest::default(),
            friction: Latest::default(),
            engine_speed: Latest::default(),
            force: Latest::default(),
            engaged: Latest::default(),
            gear_ratio: Latest::default(),
            gear: Latest::default(),
            driveline: Driveline::Unknown,
            integral: ForceIntegral::default(),
        }
    }

    /// Takes a reading; true if it told the force.
    pub(super) fn record(
        &mut self,
        vehicle: &VehicleParameters,
        now: Instant,
        signal: Signal,
        value: Option<f32>,
        speed_mps: Option<f32>,
    ) -> bool {
        match signal {
            Signal::EngineTorqueFraction => self.fraction.set(value, now),
            Signal::FrictionTorque => self.friction.set(value, now),
            Signal::EngineSpeed => self.engine_speed.set(value, now),
            Signal::DrivelineEngaged => {
                self.engaged.set(value, now);
                self.driveline_changed(vehicle, now);
            }
            Signal::GearRatio => {
                self.gear_ratio.set(value, now);
                self.driveline_changed(vehicle, now);
            }
            Signal::CurrentGear => {
                self.gear.set(value, now);
                self.driveline_changed(vehicle, now);
            }
            Signal::EngineTorque => {
                self.torque.set(value, now);
                return self.torque_changed(vehicle, now, speed_mps);
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

    /// Mean force since the last call, N.
    pub(super) fn take_mean_n(&mut self, now: Instant) -> f32 {
        self.integral.take_mean(now)
    }

    /// Mass that rotating parts add now, kg.
    pub(super) fn rotating_kg(&self, vehicle: &VehicleParameters) -> f32 {
        vehicle.rotating_kg(self.driveline)
    }

    fn torque_changed(
        &mut self,
        vehicle: &VehicleParameters,
        now: Instant,
        speed_mps: Option<f32>,
    ) -> bool {
        let Traction::Powertrain(powertrain) = &vehicle.traction else {
            return false;
        };
        if self.gear_ratio.state(now).is_none() && self.gear.state(now).is_none() {
            self.driveline = self.driveline_of_speeds(powertrain, vehicle, now, speed_mps);
        }
        let Some(net_percent) = self.net_torque_percent(now) else {
            return false;
        };
        self.integral
            .reading(vehicle.traction_n(self.driveline, net_percent), now);
        self.driveline != Driveline::Unknown
    }

    /// SPN 513 + 4154 − 514: 513 is indicated torque and holds what friction takes.
    fn net_torque_percent(&self, now: Instant) -> Option<f32> {
        let torque = self.torque.within(now, STALE)?;
        let fraction = self.fraction.within(now, STALE).unwrap_or(0.0);
        let friction = self.friction.state(now).unwrap_or(0.0);
        Some(torque + fraction - friction)
    }

    fn driveline_of_speeds(
        &self,
        powertrain: &Powertrain,
        vehicle: &VehicleParameters,
        now: Instant,
        speed_mps: Option<f32>,
    ) -> Driveline {
        match (self.engine_speed.within(now, STALE), speed_mps) {
            (Some(rpm), Some(speed_mps)) => powertrain
                .gear_of_speeds(rpm, speed_mps, vehicle.wheel_radius_m)
                .map_or(Driveline::Unknown, Driveline::Engaged),
            _ => Driveline::Unknown,
        }
    }

    fn driveline_changed(&mut self, vehicle: &VehicleParameters, now: Instant) {
        let Traction::Powertrain(powertrain) = &vehicle.traction else {
            return;
        };
        let number = self.gear.state(now);
        let is_open = self.engaged.state(now).is_some_and(|engaged| engaged < 0.5)
            || number.is_some_and(|number| number.abs() < 0.5);
        let driveline = if is_open {
            Driveline::Open
        } else {
            let of_ratio = self
                .gear_ratio
                .state(now)
                .and_then(|ratio| powertrain.gear_of_ratio(ratio));
            let of_number = number.and_then(|number| powertrain.gear(number as i32));
            of_ratio
                .or(of_number)
                .map_or(Driveline::Unknown, Driveline::Engaged)
        };
        if driveline != self.driveline {
            self.driveline = driveline;
            if let Some(net_percent) = self.net_torque_percent(now) {
                self.integral
                    .step_to(vehicle.traction_n(driveline, net_percent), now);
            }
        }
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
