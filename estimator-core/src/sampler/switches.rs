//! When the vehicle model does not hold: gear shifts and brakes, with their hold times.

use super::latest::Latest;
use crate::signal::Signal;
use crate::time::Instant;
use crate::tuning::Tuning;

/// Pressure in the service brakes that is more than a sensor's offset, Pa.
const BRAKE_PRESSURE_PA: f32 = 20_000.0;
/// Pedal travel that is more than an offset, %.
const PEDAL_PERCENT: f32 = 0.5;
/// Retarder torque that is more than the drag it always has and the step of its signal, %.
const RETARDER_PERCENT: f32 = -1.5;

/// Brakes, and until when what they and the driveline did is felt.
///
/// A brake that is on when its sender falls silent stays on until the last word is stale, and its
/// hold time on top; then nothing is known of it, as on a vehicle that never tells.
#[derive(Clone, Debug, Default)]
pub(super) struct Switches {
    brake_switch: Latest,
    brake_pedal: Latest,
    brake_pressure: Latest,
    parking_brake: Latest,
    retarder: Latest,
    shift_until: Instant,
    brake_until: Instant,
}

impl Switches {
    /// Takes a reading.
    #[inline(always)] // In Sampler::record.
    pub(super) fn record(
        &mut self,
        tuning: &Tuning,
        now: Instant,
        signal: Signal,
        value: Option<f32>,
    ) {
        match signal {
            Signal::BrakeSwitch => self.brake_switch.keep(value, now),
            Signal::BrakePedal => self.brake_pedal.keep(value, now),
            Signal::BrakePressure => self.brake_pressure.keep(value, now),
            Signal::ParkingBrake => self.parking_brake.keep(value, now),
            Signal::RetarderTorque => self.retarder.keep(value, now),
            _ => return,
        }
        self.hold(tuning, now);
    }

    /// The driveline jerks or slips now.
    pub(super) fn driveline_in_transit(&mut self, tuning: &Tuning, now: Instant) {
        self.shift_until = self.shift_until.max(now + tuning.shift_hold);
    }

    /// Hold times of what brakes now.
    pub(super) fn hold(&mut self, tuning: &Tuning, now: Instant) {
        if self.service_brakes(now) {
            self.brake_until = self.brake_until.max(now + tuning.brake_hold);
        }
        if self.retards(now) {
            self.brake_until = self.brake_until.max(now + tuning.retarder_hold);
        }
    }

    fn service_brakes(&self, now: Instant) -> bool {
        let above = |latest: &Latest, limit| latest.state(now).is_some_and(|value| value > limit);
        self.brake_switch.is_on(now)
            || self.parking_brake.is_on(now)
            || above(&self.brake_pedal, PEDAL_PERCENT)
            || above(&self.brake_pressure, BRAKE_PRESSURE_PA)
    }

    /// Whether anything tells of the service brakes.
    pub(super) fn tells_brakes(&self, now: Instant) -> bool {
        [&self.brake_switch, &self.brake_pedal, &self.brake_pressure]
            .into_iter()
            .any(|signal| signal.state(now).is_some())
    }

    fn retards(&self, now: Instant) -> bool {
        self.retarder
            .state(now)
            .is_some_and(|percent| percent < RETARDER_PERCENT)
    }

    /// Whether a shift, or its hold time, is on.
    pub(super) fn shifting(&self, now: Instant) -> bool {
        now < self.shift_until
    }

    /// Whether braking, or its hold time, is on.
    pub(super) fn braking(&self, now: Instant) -> bool {
        now < self.brake_until
    }
}
