//! Speeds of two senders: readings that go back and forth.

use super::latest::TimedValue;
use crate::scalar::Scalar;
use crate::tuning::Detection;

/// Weight of a reading in the part of those that return: 1 over their number.
const GAIN: f32 = 1.0 / 64.0;

/// Readings that return to where the speed was before the last one. Noise makes some of them, and two
/// senders of one message many: at least as many as the slower one sends.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Returns {
    /// Part of the last readings that return.
    part: f32,
    /// Last change of the speed, m/s.
    change_mps: f32,
    /// Whether any reading has returned since this was asked, also by less.
    has_returned: bool,
}

impl Returns {
    /// Takes a reading. `has_left_out` is whether another was left out since the last one, because no
    /// vehicle can have come to its speed.
    pub(super) fn take(
        &mut self,
        last: TimedValue,
        reading: &TimedValue,
        has_left_out: bool,
        resolution_mps: f32,
        tuning: &Detection,
    ) {
        let change_mps = reading.value - last.value;
        let before_mps = core::mem::replace(&mut self.change_mps, change_mps);
        let mut has_returned = has_left_out;
        if change_mps * before_mps < 0.0 {
            let by_sensor_mps = Scalar::max(0.5 * tuning.speed_step_mps, 1.5 * resolution_mps);
            let by_vehicle_mps = tuning.speed_turned_mps2 * reading.time.seconds_since(last.time);
            let turned_mps = Scalar::min(change_mps.abs(), before_mps.abs()) - by_vehicle_mps;
            has_returned |= turned_mps > by_sensor_mps;
            self.has_returned |= 3.0 * turned_mps > by_sensor_mps;
        }
        self.has_returned |= has_returned;
        let part = if has_returned { GAIN } else { 0.0 };
        let most = 1.25 * tuning.speed_turned_part;
        self.part = Scalar::min((1.0 - GAIN) * self.part + part, most);
    }

    /// Returns whether two senders send the last readings.
    pub(super) fn are_many(&self, tuning: &Detection) -> bool {
        self.part > tuning.speed_turned_part
    }

    /// Returns whether any reading has returned since this was asked. It may by noise.
    pub(super) const fn take_any(&mut self) -> bool {
        core::mem::replace(&mut self.has_returned, false)
    }
}
