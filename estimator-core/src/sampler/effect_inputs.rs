//! The inputs of effects: yaw rate, course, GNSS speed and fan.

use super::accepted_ranges::{COURSES_DEG, FANS_PERCENT, SPEEDS_MPS, YAW_RATES_RADPS};
use super::latest::Latest;
use crate::sample::EffectInputs;
use crate::signal::Signal;
use crate::time::Instant;
use crate::tuning::Tuning;
use core::ops::RangeInclusive;

/// The signals that effects depend on.
#[derive(Clone, Debug, Default)]
pub(super) struct EffectSignals {
    yaw_rate: Latest,
    yaw_rate_sum: f32,
    yaw_rates: u16,
    course: Latest,
    /// Averaged change of course, rad/s to the left.
    turn_radps: Option<f32>,
    gnss_speed: Latest,
    fan: Latest,
}

impl EffectSignals {
    /// Takes a reading. `speed_mps` is the last wheel speed.
    pub(super) fn record(
        &mut self,
        tuning: &Tuning,
        now: Instant,
        signal: Signal,
        value: Option<f32>,
        speed_mps: Option<f32>,
    ) {
        let within = |range: RangeInclusive<f32>| value.filter(|value| range.contains(value));
        match signal {
            Signal::YawRate => self.yaw_rate(now, within(YAW_RATES_RADPS)),
            Signal::Course => self.course(tuning, now, within(COURSES_DEG), speed_mps),
            Signal::GnssSpeed => self.gnss_speed.set(within(SPEEDS_MPS), now),
            Signal::Fan => self.fan.set(within(FANS_PERCENT), now),
            _ => {}
        }
    }

    fn yaw_rate(&mut self, now: Instant, radps: Option<f32>) {
        self.yaw_rate.set(radps, now);
        if let Some(radps) = radps {
            self.yaw_rate_sum += radps;
            self.yaw_rates = self.yaw_rates.saturating_add(1);
        }
    }

    fn course(
        &mut self,
        tuning: &Tuning,
        now: Instant,
        course_deg: Option<f32>,
        speed_mps: Option<f32>,
    ) {
        let timeout = tuning.hold_times.reading_timeout;
        let before = self.course.with_age(now).filter(|(_, age)| *age <= timeout);
        self.course.set(course_deg, now);
        let speed_mps = speed_mps.filter(|mps| *mps >= tuning.detection.slow_mps);
        let (Some(course_deg), Some((before_deg, since)), Some(mps)) =
            (course_deg, before, speed_mps)
        else {
            self.turn_radps = None;
            return;
        };
        let seconds = since.seconds();
        if seconds <= 0.0 {
            return;
        }
        let turned_deg = match course_deg - before_deg {
            right if right > 180.0 => right - 360.0,
            left if left < -180.0 => left + 360.0,
            turned => turned,
        };
        // Course is positive to the right, yaw rate to the left.
        let radps = -turned_deg.to_radians() / seconds;
        let length_m = mps * seconds;
        let averaged = self.turn_radps.unwrap_or(radps);
        let weight = length_m / (length_m + tuning.detection.turn_length_m);
        self.turn_radps = Some(averaged + weight * (radps - averaged));
    }

    /// Returns the course over ground with the time of its reading, °.
    pub(super) fn fresh_course(&self, tuning: &Tuning, now: Instant) -> Option<(f32, Instant)> {
        let (course_deg, age) = self.course.with_age(now)?;
        (age <= tuning.hold_times.reading_timeout).then(|| (course_deg, now - age))
    }

    /// Returns the inputs at the end of a cell, and starts the next cell.
    pub(super) fn take(&mut self, tuning: &Tuning, now: Instant, speed_mps: f32) -> EffectInputs {
        let timeout = tuning.hold_times.reading_timeout;
        let course_deg = self.course.within(now, timeout);
        let turn_radps = self
            .turn_radps
            .filter(|_| course_deg.is_some() && speed_mps >= tuning.detection.slow_mps);
        let mean = (self.yaw_rates > 0).then(|| self.yaw_rate_sum / f32::from(self.yaw_rates));
        self.yaw_rate_sum = 0.0;
        self.yaw_rates = 0;
        EffectInputs {
            yaw_rate_radps: self
                .yaw_rate
                .within(now, timeout)
                .map(|newest| mean.unwrap_or(newest))
                .or(turn_radps)
                .into(),
            course_deg: course_deg
                .filter(|_| speed_mps >= tuning.detection.slow_mps)
                .into(),
            gnss_speed_mps: self.gnss_speed.within(now, timeout).into(),
            fan_percent: self.fan.within(now, tuning.hold_times.state_timeout).into(),
            ..EffectInputs::default()
        }
    }
}
