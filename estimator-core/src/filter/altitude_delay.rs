//! Delay of GNSS altitudes: receivers that smooth them are late by many seconds.
//!
//! The climb by the forces and the climb of the altitudes are the same, but for the delay. The lag
//! at which both fit best is the delay. The altitude is then carried on by the climb since. The
//! variances of the difference at a row of lags are means that forget, and each fix updates a few.

use crate::lagged_differences::LaggedDifferences;
use crate::scalar::Scalar;
use crate::shift_in::shift_in;
use crate::tuning::MeasurementNoise;

/// Number of lags, each a second.
const LAGS: usize = 48;
/// Lags that one fix updates.
const AT_ONCE: u8 = 16;
/// Difference of vertical speeds that counts at most, m/s: beyond is an outlier.
const FASTEST_MPS: f32 = 1.0;
/// Time between two fixes that are compared, s.
const APART_S: f32 = 2.0;

/// The comparison of both climbs.
#[derive(Clone, Debug)]
pub(super) struct AltitudeDelay {
    /// Vertical speed by the forces in each of the last seconds, m/s, the newest first.
    vertical_mps: [f32; LAGS + 2],
    /// Climb, m, and time, s, since the newest.
    open: (f32, f32),
    filled: u8,
    /// The last fix that was compared, m, and the time since, s.
    fix: Option<(f32, f32)>,
    /// Vertical speed of the altitudes, m/s.
    measured_mps: Option<f32>,
    differences: LaggedDifferences<LAGS>,
    delay_s: u8,
    has_changed: bool,
}

impl AltitudeDelay {
    pub(super) const fn new() -> Self {
        Self {
            vertical_mps: [0.0; LAGS + 2],
            open: (0.0, 0.0),
            filled: 0,
            fix: None,
            measured_mps: None,
            differences: LaggedDifferences::new(),
            delay_s: 0,
            has_changed: false,
        }
    }

    /// Returns the comparison before its start, with the delay found so far.
    pub(super) fn restarted(&self) -> Self {
        Self {
            differences: self.differences.restarted(),
            delay_s: self.delay_s,
            ..Self::new()
        }
    }

    /// Notes that altitudes after here do not follow from those before.
    pub(super) fn interrupt(&mut self) {
        self.fix = None;
        self.measured_mps = None;
        self.filled = 0;
        self.open = (0.0, 0.0);
    }

    /// Returns the climb since an altitude was true, m; `None` as long as that is not known.
    pub(super) fn climb_since_m(&self) -> Option<f32> {
        let delay = usize::from(self.delay_s);
        if delay == 0 {
            return Some(0.0);
        }
        self.measured_mps.map(|mps| mps * f32::from(self.delay_s))
    }

    /// Returns whether the delay changed since the last call.
    pub(super) fn take_change(&mut self) -> bool {
        core::mem::take(&mut self.has_changed)
    }

    /// Advances over a cell.
    pub(super) fn advance(&mut self, climb_m: f32, duration_s: f32) {
        self.open.0 += climb_m;
        self.open.1 += duration_s;
        if let Some((_, since_s)) = &mut self.fix {
            *since_s += duration_s;
        }
        if self.open.1 < 1.0 {
            return;
        }
        if self.open.1 > 3.0 {
            // It stands, or nearly.
            self.interrupt();
            return;
        }
        let (climb_m, seconds) = core::mem::take(&mut self.open);
        shift_in(&mut self.vertical_mps, climb_m / seconds);
        self.open = (0.0, 0.0);
        self.filled = self.filled.saturating_add(1).min(LAGS as u8 + 2);
    }

    /// Takes an altitude as it was received, m.
    pub(super) fn fix(&mut self, altitude_m: f32, tuning: &MeasurementNoise) {
        let Some((before_m, since_s)) = self.fix else {
            self.fix = Some((altitude_m, 0.0));
            return;
        };
        if since_s < APART_S {
            return;
        }
        self.fix = Some((altitude_m, 0.0));
        if since_s > 2.0 * APART_S {
            return;
        }
        let measured_mps = (altitude_m - before_m) / since_s;
        self.measured_mps = Some(measured_mps);
        if usize::from(self.filled) < LAGS + 2 {
            return;
        }
        let gain = self.differences.gain(tuning.delay_readings);
        if self.differences.begins_round() {
            self.decide(tuning);
        }
        let vertical_mps = &self.vertical_mps;
        self.differences.update(AT_ONCE, gain, |lag, mean_mps| {
            let [newer, older] = vertical_mps.get(lag..lag + 2)?.try_into().ok()?;
            let by_forces_mps: f32 = 0.5 * (newer + older);
            let apart = measured_mps - by_forces_mps - mean_mps;
            Some(Scalar::min(FASTEST_MPS, Scalar::max(-FASTEST_MPS, apart)))
        });
    }

    fn decide(&mut self, tuning: &MeasurementNoise) {
        if self.differences.rounds() < tuning.delay_readings / 4 {
            return;
        }
        let best = self.differences.best();
        let variance = |lag: usize| self.differences.variance(lag);
        let at_now = Scalar::min(variance(0), variance(1));
        let is_late = best > 1 && variance(best) < tuning.delay_part * at_now;
        let delay_s = if is_late { best as u8 } else { 0 };
        // A second more or less is no change: each one sets the altitude anew. From none it is two
        // seconds at least.
        if delay_s.abs_diff(self.delay_s) > 1 {
            self.delay_s = delay_s;
            self.has_changed = true;
        }
    }
}
