//! What else the bus tells that effects depend on.

use super::latest::Latest;
use crate::maybe::Maybe;
use crate::signal::Signal;
use crate::time::{Duration, Instant};
use core::ops::RangeInclusive;

/// What the vehicle went through in a cell, besides its place and its load.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Circumstances {
    /// Time in motion since the start or the last long stop, s.
    pub driven_s: f32,
    /// Yaw rate, positive to the left, rad/s: mean of the readings (SPN 1808), else from the change
    /// of course.
    pub yaw_rate_radps: Maybe,
    /// Course over ground, clockwise from north, °.
    pub course_deg: Maybe,
    /// Speed over ground, m/s.
    pub gnss_speed_mps: Maybe,
    /// Fan drive (SPN 975), %.
    pub fan_percent: Maybe,
    /// Outside temperature, °C.
    pub ambient_celsius: Maybe,
    /// Whether the driveline passes torque; a measured force always arrives.
    pub engaged: bool,
}

/// A value that changes as the vehicle moves, and is older than this, is of another place.
const FRESH: Duration = Duration::from_millis(2_500);
/// Slowest speed at which a course over ground has a meaning, m/s.
const SLOWEST_COURSE_MPS: f32 = 2.0;
/// Slowest speed at which its change has one, m/s.
const SLOWEST_TURN_MPS: f32 = 3.0;
/// Way over which the change of course is averaged, m: a receiver's course scatters by 0.3°.
const TURN_LENGTH_M: f32 = 50.0;

/// What can be, in the units of [`Circumstances`].
const YAW_RATES: RangeInclusive<f32> = -2.0..=2.0;
const COURSES: RangeInclusive<f32> = 0.0..=360.0;
const SPEEDS: RangeInclusive<f32> = 0.0..=70.0;
const FANS: RangeInclusive<f32> = 0.0..=100.0;

/// The signals that tell.
#[derive(Clone, Debug, Default)]
pub(super) struct CircumstancesInput {
    yaw_rate: Latest,
    yaw_rate_sum: f32,
    yaw_rates: u16,
    course: Latest,
    /// Averaged change of course, rad/s to the left.
    turn_radps: Option<f32>,
    gnss_speed: Latest,
    fan: Latest,
}

impl CircumstancesInput {
    /// Takes a reading, at a speed.
    pub(super) fn record(
        &mut self,
        now: Instant,
        signal: Signal,
        value: Option<f32>,
        speed_mps: Option<f32>,
    ) {
        let within = |range: RangeInclusive<f32>| value.filter(|value| range.contains(value));
        match signal {
            Signal::YawRate => self.yaw_rate(now, within(YAW_RATES)),
            Signal::Course => self.course(now, within(COURSES), speed_mps),
            Signal::GnssSpeed => self.gnss_speed.set(within(SPEEDS), now),
            Signal::Fan => self.fan.set(within(FANS), now),
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

    fn course(&mut self, now: Instant, course_deg: Option<f32>, speed_mps: Option<f32>) {
        let before = self.course.since(now).filter(|(_, age)| *age <= FRESH);
        self.course.set(course_deg, now);
        let speed_mps = speed_mps.filter(|mps| *mps >= SLOWEST_TURN_MPS);
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
        // Course counts to the right, yaw to the left.
        let radps = -turned_deg.to_radians() / seconds;
        let way_m = mps * seconds;
        let averaged = self.turn_radps.unwrap_or(radps);
        let weight = way_m / (way_m + TURN_LENGTH_M);
        self.turn_radps = Some(averaged + weight * (radps - averaged));
    }

    /// At the end of a cell, which begins the next one.
    pub(super) fn take(&mut self, now: Instant, speed_mps: f32) -> Circumstances {
        let course_deg = self.course.within(now, FRESH);
        let turn_radps = self
            .turn_radps
            .filter(|_| course_deg.is_some() && speed_mps >= SLOWEST_TURN_MPS);
        let mean = (self.yaw_rates > 0).then(|| self.yaw_rate_sum / f32::from(self.yaw_rates));
        self.yaw_rate_sum = 0.0;
        self.yaw_rates = 0;
        Circumstances {
            yaw_rate_radps: self
                .yaw_rate
                .within(now, FRESH)
                .map(|newest| mean.unwrap_or(newest))
                .or(turn_radps)
                .into(),
            course_deg: course_deg
                .filter(|_| speed_mps >= SLOWEST_COURSE_MPS)
                .into(),
            gnss_speed_mps: self.gnss_speed.within(now, FRESH).into(),
            fan_percent: self.fan.state(now).into(),
            ..Circumstances::default()
        }
    }
}
