//! When the vehicle model does not hold: gear shifts and brakes, with their hold times.

use super::latest::Latest;
use crate::signal::Signal;
use crate::time::Instant;
use crate::tuning::Tuning;

/// Pressure in the service brakes that is more than a sensor's offset, Pa.
const BRAKE_PRESSURE_PA: f32 = 20_000.0;
/// Pedal travel or retarder torque that is more than an offset, %.
const BRAKE_PERCENT: f32 = 0.5;

/// Switches and what they imply.
#[derive(Clone, Debug, Default)]
pub(super) struct Switches {
    shifting: Latest,
    engaged: Latest,
    brake_switch: Latest,
    brake_pedal: Latest,
    brake_pressure: Latest,
    retarder: Latest,
    shift_until: Instant,
    brake_until: Instant,
}

impl Switches {
    /// Takes a reading.
    pub(super) fn record(
        &mut self,
        tuning: &Tuning,
        now: Instant,
        signal: Signal,
        value: Option<f32>,
    ) {
        match signal {
            Signal::ShiftInProcess => self.shifting.set(value, now),
            Signal::DrivelineEngaged => {
                // Opening and closing jerk; in between an open driveline is no riddle.
                let was_open = self.engaged.last().is_some_and(|engaged| engaged < 0.5);
                let is_open = value.map_or(was_open, |engaged| engaged < 0.5);
                if is_open != was_open {
                    self.shift_until = self.shift_until.max(now + tuning.shift_hold);
                }
                self.engaged.set(value, now);
            }
            Signal::BrakeSwitch => self.brake_switch.set(value, now),
            Signal::BrakePedal => self.brake_pedal.set(value, now),
            Signal::BrakePressure => self.brake_pressure.set(value, now),
            Signal::RetarderTorque => self.retarder.set(value, now),
            _ => return,
        }
        if self.shifting.is_on(now) {
            self.shift_until = self.shift_until.max(now + tuning.shift_hold);
        }
        if self.brakes(now) {
            self.brake_until = self.brake_until.max(now + tuning.brake_hold);
        }
    }

    fn brakes(&self, now: Instant) -> bool {
        let above = |latest: &Latest, limit| latest.state(now).is_some_and(|value| value > limit);
        self.brake_switch.is_on(now)
            || above(&self.brake_pedal, BRAKE_PERCENT)
            || above(&self.brake_pressure, BRAKE_PRESSURE_PA)
            || self
                .retarder
                .state(now)
                .is_some_and(|torque| torque < -BRAKE_PERCENT)
    }

    /// Whether a shift, or its hold time, is on.
    pub(super) fn shifting(&self, now: Instant) -> bool {
        now < self.shift_until || self.shifting.is_on(now)
    }

    /// Whether braking, or its hold time, is on.
    pub(super) fn braking(&self, now: Instant) -> bool {
        now < self.brake_until || self.brakes(now)
    }
}
