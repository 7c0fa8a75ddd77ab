//! Sensors that measure the slope directly: one measurement a cell at most.
//!
//! A GNSS receiver's vertical speed over the speed along the road is the sine of the slope angle. The
//! pitch of the body is the angle itself, with the errors of a body on springs. Where a cell has both,
//! the vertical speed counts: it has no offset.

use super::accepted_ranges::{PITCHES_DEG, VERTICAL_SPEEDS_MPS};
use crate::sample::{SlopeMeasurement, SlopeSensor};

/// Speed below which a vertical speed says nothing of the slope, m/s: its noise is some 2 % there.
const SLOWEST_MPS: f32 = 5.0;
/// Largest sine of a road's slope angle, %.
const STEEPEST_PERCENT: f32 = 50.0;

/// The readings since the last cell.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct SlopeSensors {
    vertical_mps: Option<f32>,
    pitches: u16,
    sum_deg: f32,
}

impl SlopeSensors {
    /// Takes a vertical speed. The newest one in a cell counts.
    pub(super) fn vertical_speed(&mut self, value: Option<f32>) {
        self.vertical_mps = value.filter(|mps| VERTICAL_SPEEDS_MPS.contains(mps));
    }

    /// Takes a pitch.
    pub(super) fn pitch(&mut self, value: Option<f32>) {
        if let Some(deg) = value.filter(|deg| PITCHES_DEG.contains(deg))
            && self.pitches < u16::MAX
        {
            self.sum_deg += deg;
            self.pitches += 1;
        }
    }

    /// Returns the measurement of a cell that is driven with a speed, and begins the next one.
    #[inline]
    pub(super) fn take(&mut self, speed_mps: f32) -> Option<SlopeMeasurement> {
        if self.vertical_mps.is_none() && self.pitches == 0 {
            return None;
        }
        core::mem::take(self).measurement(speed_mps)
    }

    #[inline(never)] // Not for the vehicles without such a sensor.
    fn measurement(self, speed_mps: f32) -> Option<SlopeMeasurement> {
        let (slope_percent, sensor) = match self.vertical_mps {
            Some(vertical_mps) if speed_mps >= SLOWEST_MPS => {
                (100.0 * vertical_mps / speed_mps, SlopeSensor::VerticalSpeed)
            }
            _ if self.pitches > 0 => {
                let radians = (self.sum_deg / f32::from(self.pitches)).to_radians();
                // The sine, to the third order: exact to 0.003 % of slope for any road.
                let sine = radians * (1.0 - radians * radians / 6.0);
                (100.0 * sine, SlopeSensor::Pitch)
            }
            _ => return None,
        };
        (slope_percent.abs() <= STEEPEST_PERCENT).then_some(SlopeMeasurement {
            slope_percent,
            sensor,
        })
    }
}
