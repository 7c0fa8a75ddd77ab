//! Sign and unit of the accelerometer, against the speed of the wheels.
//!
//! An accelerometer reads the change of the speed and the slope. Over hills a vehicle slows down where
//! the slope is positive, so that the readings themselves say nothing. But the slope changes slowly: from
//! one second to the next, where a brake or a shift changes the acceleration, the reading changes by as
//! much.

use super::warning::Warning;
use estimator_core::{Instant, Signal};

/// Shortest and longest window over which an acceleration is measured, s.
const WINDOW_S: (f64, f64) = (1.0, 1.6);
/// Least speed at its ends: wheel sensors are coarse below, m/s.
const LEAST_MPS: f64 = 1.5;
/// Least change of the acceleration from window to window, m/s². A slope changes the reading by 0.06.
const LEAST_CHANGE_MPS2: f64 = 0.2;
/// Least number of such changes, and how many sigmas a finding is away from what is right.
const CHANGES: u32 = 8;
const SIGMAS: f64 = 4.0;
/// Slopes of the readings on the accelerations that no error of a sensor makes.
const PLAUSIBLE: (f64, f64) = (0.5, 2.0);
/// Standard gravity, m/s².
const GRAVITY: f64 = 9.806_65;

/// Collects readings and speeds.
#[derive(Clone, Debug, Default)]
pub(super) struct Accelerometer {
    speed_from: Option<Signal>,
    window: Option<Window>,
    /// Acceleration and mean reading of the window before.
    before: Option<(f64, f64)>,
    squares: f64,
    products: f64,
    reading_squares: f64,
    changes: u32,
}

/// A window that is open.
#[derive(Clone, Copy, Debug)]
struct Window {
    from: Instant,
    from_mps: f64,
    readings_sum: f64,
    readings: u32,
}

impl Accelerometer {
    /// Takes a reading, m/s².
    pub(super) fn reading(&mut self, mps2: f64) {
        if let Some(window) = &mut self.window {
            window.readings_sum += mps2;
            window.readings += 1;
        }
    }

    /// Takes a speed of wheels, m/s. The front axle's counts until there is another.
    pub(super) fn speed(&mut self, now: Instant, signal: Signal, mps: f64) {
        if signal == Signal::FrontAxleSpeed && self.speed_from == Some(Signal::WheelSpeed) {
            return;
        }
        let is_other = self.speed_from.replace(signal) != Some(signal);
        let Some(window) = self.window.filter(|_| !is_other) else {
            return self.begin(now, mps);
        };
        let seconds = now.since(window.from).as_secs_f64();
        if seconds < WINDOW_S.0 {
            return;
        }
        let is_sound =
            seconds <= WINDOW_S.1 && window.readings > 0 && window.from_mps.min(mps) >= LEAST_MPS;
        let this = is_sound.then(|| {
            let mean = window.readings_sum / f64::from(window.readings);
            ((mps - window.from_mps) / seconds, mean)
        });
        if let (Some(before), Some(this)) = (self.before, this) {
            self.change(this.0 - before.0, this.1 - before.1);
        }
        self.begin(now, mps);
        self.before = this;
    }

    fn begin(&mut self, now: Instant, mps: f64) {
        self.before = None;
        self.window = Some(Window {
            from: now,
            from_mps: mps,
            readings_sum: 0.0,
            readings: 0,
        });
    }

    fn change(&mut self, accelerations_mps2: f64, readings: f64) {
        if accelerations_mps2.abs() >= LEAST_CHANGE_MPS2 {
            self.squares += accelerations_mps2 * accelerations_mps2;
            self.products += accelerations_mps2 * readings;
            self.reading_squares += readings * readings;
            self.changes += 1;
        }
    }

    /// Returns the slope of the readings on the accelerations and its sigma; `None` where too little is
    /// known.
    fn slope(&self) -> Option<(f64, f64)> {
        if self.changes < CHANGES {
            return None;
        }
        let slope = self.products / self.squares;
        let rest = (self.reading_squares - slope * self.products).max(0.0);
        let variance = rest / f64::from(self.changes - 1) / self.squares;
        Some((slope, variance.sqrt()))
    }

    /// Returns what is not plausible.
    pub(super) fn judge(&self) -> Option<Warning> {
        let (slope, sigma) = self.slope()?;
        let margin = SIGMAS * sigma;
        if slope + margin < 0.0 {
            return Some(Warning::minor(
                "accelerometer_sign",
                format!(
                    "the accelerometer changes by {slope:.2} times the change of the vehicle's \
                     acceleration: it is upside down, or its axis points backwards"
                ),
                "turn the sign of the acceleration (ACCS, SPN 5348; column \
                 longitudinal_acceleration_mps2): it is positive where the vehicle speeds up",
            ));
        }
        let is_wrong = slope + margin < PLAUSIBLE.0 || slope - margin > PLAUSIBLE.1;
        is_wrong.then(|| {
            let in_g = slope * GRAVITY;
            let looks = if (PLAUSIBLE.0..PLAUSIBLE.1).contains(&in_g) {
                ": it looks like g"
            } else {
                ""
            };
            Warning::minor(
                "accelerometer_unit",
                format!(
                    "the accelerometer changes by {slope:.3} times the change of the vehicle's \
                     acceleration{looks}"
                ),
                "give the acceleration in m/s² (column longitudinal_acceleration_mps2): multiply g \
                 by 9.80665",
            )
        })
    }
}
