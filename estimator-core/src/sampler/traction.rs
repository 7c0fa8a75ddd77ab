//! Torque, gears and forces become the mean traction force of an interval.

use super::latest::{Latest, TimedValue};
use super::torque_rests::TorqueRests;
use crate::context::Context;
use crate::effect::Acts;
use crate::model::Model;
use crate::sample::TorqueRest;
use crate::signal::Signal;
use crate::time::Instant;
use crate::vehicle::{Driveline, Traction};

/// The signals of the traction force, and its integral since the last speed.
#[derive(Clone, Debug)]
pub(super) struct TractionInput {
    fraction: Latest,
    torque: Latest,
    rest: TorqueRests,
    friction: Latest,
    /// Net torque of a shaft that is reported in Nm, % of the reference torque. It goes before the
    /// engine's parts of its reference torque.
    shaft_torque: Latest,
    shaft: Shaft,
    force: Latest,
    driveline: Driveline,
    driveline_was_known: bool,
    integral: ForceIntegral,
}

/// The shaft whose torque is reported in Nm.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Shaft {
    /// None so far.
    None,
    Engine,
    Motor,
}

impl TractionInput {
    pub(super) fn new() -> Self {
        Self {
            fraction: Latest::default(),
            torque: Latest::default(),
            rest: TorqueRests::default(),
            friction: Latest::default(),
            shaft_torque: Latest::default(),
            shaft: Shaft::None,
            force: Latest::default(),
            driveline: Driveline::Unknown,
            driveline_was_known: false,
            integral: ForceIntegral::default(),
        }
    }

    /// Takes a reading. Returns whether it gave the force.
    #[inline(always)] // In Sampler::record.
    pub(super) fn record(
        &mut self,
        context: &Context,
        now: Instant,
        signal: Signal,
        value: Option<f32>,
    ) -> bool {
        match signal {
            Signal::EngineTorqueFraction => self.fraction.set(value, now),
            // It follows engine speed and temperature: the last value is closer than none.
            Signal::FrictionTorque => self.friction.set_if_available(value, now),
            Signal::EngineTorque | Signal::NetEngineTorque | Signal::MotorTorque => {
                let is_new = if signal == Signal::EngineTorque {
                    self.take_part(context, now, value)
                } else {
                    self.take_shaft(context, now, signal, value)
                };
                return is_new && self.torque_changed(context, now);
            }
            Signal::TractionForce => {
                self.force.set(value, now);
                if let (Some(force_n), Traction::Force) = (value, &context.model.vehicle.traction) {
                    self.integral.reading(force_n, now);
                    return true;
                }
            }
            _ => {}
        }
        false
    }

    /// Takes the state of the driveline. Returns whether it opened, closed or changed gear.
    pub(super) fn set_driveline(
        &mut self,
        context: &Context,
        now: Instant,
        driveline: Driveline,
    ) -> bool {
        if driveline == self.driveline {
            return false;
        }
        // The first report is no change.
        let tolerance = context.tuning.detection.gear_tolerance;
        let is_step = self.driveline_was_known && !driveline.is_nearly(&self.driveline, tolerance);
        self.driveline_was_known = true;
        self.driveline = driveline;
        if let Some(net_percent) = self.net_torque_percent(context, now) {
            self.integral
                .step_to(context.model.traction_n(driveline, net_percent), now);
        }
        is_step
    }

    /// Returns whether the force is known.
    pub(super) fn is_known(&self, context: &Context, now: Instant) -> bool {
        let timeout = context.tuning.hold_times.reading_timeout;
        match (&context.model.vehicle.traction, self.driveline) {
            (Traction::Force, _) => self.force.within(now, timeout).is_some(),
            (Traction::Powertrain(_), Driveline::Open) => true,
            (Traction::Powertrain(_), Driveline::Engaged(_)) => {
                self.torque.within(now, timeout).is_some()
                    || self.shaft_torque.within(now, timeout).is_some()
            }
            (Traction::Powertrain(_), Driveline::Unknown) => false,
        }
    }

    /// Returns the rests of the torque since the last call.
    pub(super) fn take_rests(&mut self, now: Instant) -> TorqueRest {
        self.rest.take(now)
    }

    /// Returns whether the driveline passes torque; true for a measured force.
    pub(super) fn is_engaged(&self, model: &Model) -> bool {
        match model.vehicle.traction {
            Traction::Force => true,
            Traction::Powertrain(_) => matches!(self.driveline, Driveline::Engaged(_)),
        }
    }

    /// Returns the mean force since the last call, N.
    pub(super) fn take_mean_n(&mut self, now: Instant) -> f32 {
        self.integral.take_mean(now)
    }

    /// Returns the mass that rotating parts add, kg.
    pub(super) fn rotating_kg(&self, model: &Model) -> f32 {
        model.rotating_kg(self.driveline)
    }

    /// Takes the engine torque, a part of the reference torque. Returns whether it is new and counts.
    #[inline(always)] // Called once.
    fn take_part(&mut self, context: &Context, now: Instant, value: Option<f32>) -> bool {
        self.torque.set(value, now);
        self.shaft_percent(context, now).is_none()
    }

    /// Takes the torque of a shaft, Nm. That of a motor goes before that of an engine. Returns whether
    /// it is new and counts.
    #[inline(never)] // Rare.
    fn take_shaft(
        &mut self,
        context: &Context,
        now: Instant,
        signal: Signal,
        value: Option<f32>,
    ) -> bool {
        let Traction::Powertrain(powertrain) = &context.model.vehicle.traction else {
            return false;
        };
        let shaft = if signal == Signal::MotorTorque {
            Shaft::Motor
        } else {
            Shaft::Engine
        };
        let is_second = self.shaft == Shaft::Motor && shaft == Shaft::Engine;
        if is_second && self.shaft_percent(context, now).is_some() {
            return false;
        }
        let percent = value.map(|torque_nm| 100.0 * torque_nm / powertrain.reference_torque_nm);
        self.shaft = shaft;
        self.shaft_torque.set(percent, now);
        true
    }

    /// Returns the torque of the shaft, % of the reference torque.
    #[inline]
    fn shaft_percent(&self, context: &Context, now: Instant) -> Option<f32> {
        if self.shaft == Shaft::None {
            return None;
        }
        let timeout = context.tuning.hold_times.reading_timeout;
        self.shaft_torque.within(now, timeout)
    }

    fn torque_changed(&mut self, context: &Context, now: Instant) -> bool {
        let model = &context.model;
        if model.vehicle.traction == Traction::Force {
            return false;
        }
        let Some(net_percent) = self.net_torque_percent(context, now) else {
            return false;
        };
        let scale = model.effects.factor(Acts::Traction);
        let per_percent_n = scale * model.traction_n(self.driveline, 1.0);
        self.rest.torque(net_percent, per_percent_n, now);
        self.integral
            .reading(model.traction_n(self.driveline, net_percent), now);
        self.driveline != Driveline::Unknown
    }

    /// Returns the net torque, % of the reference torque: that of the shaft, else SPN 513 + 4154 −
    /// 514. SPN 513 is indicated torque, which includes friction.
    #[inline(never)] // Called from several places.
    pub(super) fn net_torque_percent(&self, context: &Context, now: Instant) -> Option<f32> {
        let timeout = context.tuning.hold_times.reading_timeout;
        if let Some(shaft) = self.shaft_percent(context, now) {
            return Some(shaft);
        }
        let torque = self.torque.within_inlined(now, timeout)?;
        let fraction = self.fraction.within_inlined(now, timeout).unwrap_or(0.0);
        let friction = self.friction.last().unwrap_or(0.0);
        Some(torque + fraction - friction)
    }
}

/// The integral of the force over time since the last speed reading.
#[derive(Clone, Copy, Debug, Default)]
struct ForceIntegral {
    newton_seconds: f32,
    seconds: f32,
    last: Option<TimedValue>,
}

impl ForceIntegral {
    /// Takes a reading of the force, which is linear in time since the last one.
    fn reading(&mut self, force_n: f32, now: Instant) {
        let from_n = self.last.map_or(force_n, |last| last.value);
        self.extend(0.5 * (from_n + force_n), now);
        self.last = Some(TimedValue {
            value: force_n,
            time: now,
        });
    }

    /// Takes a step of the force (a gear, a clutch): the last force holds until now.
    fn step_to(&mut self, force_n: f32, now: Instant) {
        self.hold(now);
        self.last = Some(TimedValue {
            value: force_n,
            time: now,
        });
    }

    fn hold(&mut self, now: Instant) {
        if let Some(last) = self.last {
            self.extend(last.value, now);
            self.last = Some(TimedValue {
                value: last.value,
                time: now,
            });
        }
    }

    fn extend(&mut self, mean_n: f32, now: Instant) {
        if let Some(last) = self.last {
            let seconds = now.seconds_since(last.time);
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
