//! The force of a retarder: its torque, % of its reference torque, at the propeller shaft.

use super::brakes::Brakes;
use super::latest::TimedValue;
use crate::context::Context;
use crate::scalar::Scalar;
use crate::signal::Signal;
use crate::time::Instant;
use crate::vehicle::Traction;

/// Reference torque of a retarder over that of the engine, where no message reports it.
const USUAL_REFERENCE: f32 = 1.4;

/// The retarder's force, and its integral since the last speed.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Retarder {
    reference_nm: Option<f32>,
    last: Option<TimedValue>,
    newton_seconds: f32,
    seconds: f32,
}

impl Retarder {
    /// Takes the reference torque that the retarder reports, Nm.
    pub(super) fn set_reference(&mut self, value: Option<f32>) {
        self.reference_nm = value.filter(|nm| *nm > 0.0).or(self.reference_nm);
    }

    /// Takes a reading of torque or force.
    pub(super) fn record(
        &mut self,
        context: &Context,
        now: Instant,
        signal: Signal,
        value: Option<f32>,
    ) {
        let Some(value) = value else { return };
        let force_n = if signal == Signal::RetarderForce {
            value.abs()
        } else {
            self.force_n(context, Scalar::min(0.0, value))
        };
        self.hold(now);
        self.last = Some(TimedValue {
            value: force_n,
            time: now,
        });
    }

    fn force_n(&self, context: &Context, percent: f32) -> f32 {
        let Traction::Powertrain(powertrain) = &context.model.vehicle.traction else {
            return 0.0;
        };
        let reference_nm = self
            .reference_nm
            .unwrap_or(USUAL_REFERENCE * powertrain.reference_torque_nm);
        -0.01 * percent * reference_nm * powertrain.final_drive_ratio
            / context.model.wheel_radius_m()
    }

    fn hold(&mut self, now: Instant) {
        if let Some(last) = &mut self.last {
            let seconds = now.seconds_since(last.time);
            self.newton_seconds += last.value * seconds;
            self.seconds += seconds;
            last.time = now;
        }
    }

    /// Returns the mean force since the last call, N.
    pub(super) fn take_mean_n(&mut self, context: &Context, brakes: &Brakes, now: Instant) -> f32 {
        self.hold(now);
        let mean = if self.seconds > 0.0 {
            self.newton_seconds / self.seconds
        } else {
            0.0
        };
        self.newton_seconds = 0.0;
        self.seconds = 0.0;
        if brakes.retarder_percent(&context.tuning, now) == 0.0 {
            self.last = self.last.filter(|last| last.value == 0.0);
        }
        mean
    }
}
