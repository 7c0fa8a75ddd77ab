//! Reported brakes, and their hold time.
//!
//! The hold time after gear shifts is in `sampler/parts.rs` (`Parts::hold_shift`).

use super::latest::Latest;
use crate::scalar::Scalar;
use crate::signal::Signal;
use crate::time::Instant;
use crate::tuning::Tuning;

/// Brake signals, and the end of their hold time.
///
/// A brake that is on when its sender stops sending stays on until its last value is stale, and for
/// its hold time after that. Then nothing is known of it, as on a vehicle without brake signals.
#[derive(Clone, Debug, Default)]
pub(super) struct Brakes {
    switch: Latest,
    foundation: Latest,
    pedal: Latest,
    pressure: Latest,
    parking_brake: Latest,
    retarder: Latest,
    until: Instant,
    service_until: Instant,
}

impl Brakes {
    /// Takes a reading.
    #[inline(never)] // See Sampler::record().
    pub(super) fn record(
        &mut self,
        tuning: &Tuning,
        now: Instant,
        signal: Signal,
        value: Option<f32>,
    ) {
        match signal {
            // Two reports of one thing: whichever is on extends the hold time.
            Signal::BrakeSwitch | Signal::BrakeLight => self.switch.set_if_available(value, now),
            Signal::FoundationBrake => self.foundation.set_if_available(value, now),
            Signal::BrakePedal => self.pedal.set_if_available(value, now),
            Signal::BrakePressure => self.pressure.set_if_available(value, now),
            Signal::ParkingBrake => self.parking_brake.set_if_available(value, now),
            Signal::RetarderTorque => self.retarder.set_if_available(value, now),
            Signal::RetarderForce => {
                let detection = &tuning.detection;
                let torque_percent = value.map(|force_n| {
                    if force_n.abs() > detection.retarder_force_n {
                        detection.retarder_percent - 1.0
                    } else {
                        0.0
                    }
                });
                self.retarder.set_if_available(torque_percent, now);
            }
            _ => return,
        }
        self.hold(tuning, now);
    }

    /// Extends the hold time while a brake is on.
    pub(super) fn hold(&mut self, tuning: &Tuning, now: Instant) {
        let hold_times = &tuning.hold_times;
        if self.service_brakes(tuning, now) {
            self.until = self.until.max(now + hold_times.hold);
            self.service_until = self.service_until.max(now + hold_times.hold);
        }
        if self.retards(tuning, now) {
            self.until = self.until.max(now + hold_times.hold);
        }
    }

    fn service_brakes(&self, tuning: &Tuning, now: Instant) -> bool {
        let timeout = tuning.hold_times.state_timeout;
        let above = |latest: &Latest, limit| latest.passes(now, timeout, |value| value > limit);
        self.switch.is_on(now, timeout)
            || self.foundation.is_on(now, timeout)
            || self.parking_brake.is_on(now, timeout)
            || above(&self.pedal, tuning.detection.brake_pedal_percent)
            || above(&self.pressure, tuning.detection.brake_pressure_pa)
    }

    fn retards(&self, tuning: &Tuning, now: Instant) -> bool {
        let timeout = tuning.hold_times.state_timeout;
        let least = tuning.detection.retarder_percent;
        self.retarder
            .passes(now, timeout, |percent| percent < least)
    }

    /// Returns whether a brake that reports no force, or its hold time, is on.
    pub(super) fn service_brakes_are_on(&self, now: Instant) -> bool {
        now < self.service_until
    }

    /// Returns the retarder's torque, % of its reference torque: not positive.
    pub(super) fn retarder_percent(&self, tuning: &Tuning, now: Instant) -> f32 {
        let timeout = tuning.hold_times.state_timeout;
        self.retarder
            .within(now, timeout)
            .map_or(0.0, |percent| Scalar::min(0.0, percent))
    }

    /// Returns whether a brake, or its hold time, is on.
    pub(super) fn are_on(&self, now: Instant) -> bool {
        now < self.until
    }
}
