//! The automated gearbox: selection of gears, and interruption of torque during shifts.

use super::truck::{IDLE_RPM, Truck};
use rand::RngExt;
use rand_chacha::ChaCha8Rng;
use std::ops::Range;

/// Duration of a shift, s.
const SHIFT_S: Range<f64> = 0.8..1.2;
/// Part of a shift in which the torque is reduced before the driveline opens.
const RAMP_DOWN_PART: f64 = 0.2;
/// The gearbox shifts down below this engine speed, rpm.
const LOWEST_RPM: f64 = 950.0;
/// Engine speed up to which full load holds a gear, rpm.
const FULL_LOAD_RPM: f64 = 1550.0;
/// The gearbox shifts up above this engine speed, rpm.
const HIGHEST_RPM: f64 = 2000.0;
/// Lowest engine speed after an upshift, rpm.
const AFTER_UPSHIFT_RPM: f64 = 1050.0;
/// Highest engine speed after a downshift, rpm.
const AFTER_DOWNSHIFT_RPM: f64 = 1800.0;
/// Smallest ratio of the force in a higher gear to the resistance.
const UPSHIFT_RESERVE: f64 = 1.1;
/// Smallest ratio of the force in a lower gear to that in the current gear.
const DOWNSHIFT_GAIN: f64 = 1.05;
/// Deceleration at full load that triggers a downshift, m/s².
const LOSING_MPS2: f64 = -0.02;
/// Speed that full load may lose before it does, m/s.
const TOLERATED_LOSS_MPS: f64 = 1.5;
/// Shortest time between shifts, s.
const REST_S: f64 = 2.0;
/// Largest number of gears in one upshift.
const LONGEST_STEP: usize = 2;
/// Acceleration that the starting gear must give on the level, m/s².
const LAUNCH_MPS2: f64 = 0.6;

/// Inputs of the gearbox.
#[derive(Clone, Copy, Debug)]
pub struct Situation {
    /// Speed, m/s.
    pub speed_mps: f64,
    /// Speed that the driver wants, m/s.
    pub set_speed_mps: f64,
    /// Acceleration, m/s².
    pub acceleration_mps2: f64,
    /// Resistance: traction minus the accelerating force, N.
    pub resisting_n: f64,
    /// True if the engine is at its limit and more torque is requested.
    pub at_full_load: bool,
}

/// A shift in progress.
#[derive(Clone, Copy, Debug)]
struct ShiftInProgress {
    to: usize,
    elapsed_s: f64,
    duration_s: f64,
}

/// The path of the torque.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Flow {
    /// Through this gear; 0 is neutral.
    Through(usize),
    /// Through this gear, reduced before a shift.
    Leaving(usize),
    /// Open: the engine synchronizes to the next gear, `left_s` before the driveline closes.
    Open {
        /// The next gear.
        to: usize,
        /// Time until the driveline closes again.
        left_s: f64,
    },
}

/// The gearbox.
#[derive(Clone, Debug)]
pub struct Gearbox {
    gear: usize,
    shift: Option<ShiftInProgress>,
    rested_s: f64,
    rng: ChaCha8Rng,
}

impl Gearbox {
    /// Creates a gearbox in `gear`, with no recent shift.
    #[must_use]
    pub const fn new(gear: usize, rng: ChaCha8Rng) -> Self {
        Self {
            gear,
            shift: None,
            rested_s: REST_S,
            rng,
        }
    }

    /// Returns the gear as reported on the bus: the old one until a shift is over.
    #[must_use]
    pub const fn gear(&self) -> usize {
        self.gear
    }

    /// Returns the selected gear.
    #[must_use]
    pub fn selected(&self) -> usize {
        self.shift.map_or(self.gear, |shift| shift.to)
    }

    /// Returns true during a shift.
    #[must_use]
    pub const fn is_shifting(&self) -> bool {
        self.shift.is_some()
    }

    /// Engages a gear at standstill.
    pub const fn engage(&mut self, gear: usize) {
        self.gear = gear;
    }

    /// Opens the driveline at standstill, shift or not.
    pub fn park(&mut self) {
        self.gear = 0;
        self.shift = None;
    }

    /// Advances by `step_s` and returns the path of the torque.
    pub fn step(&mut self, truck: &Truck, now: &Situation, step_s: f64) -> Flow {
        if self.shift.is_none() {
            self.rested_s += step_s;
            if let Some(to) = self.wanted(truck, now) {
                self.shift = Some(ShiftInProgress {
                    to,
                    elapsed_s: 0.0,
                    duration_s: self.rng.random_range(SHIFT_S),
                });
            }
        }
        let Some(shift) = &mut self.shift else {
            return Flow::Through(self.gear);
        };
        shift.elapsed_s += step_s;
        let left_s = shift.duration_s - shift.elapsed_s;
        if left_s <= 0.0 {
            self.gear = shift.to;
            self.shift = None;
            self.rested_s = 0.0;
            Flow::Through(self.gear)
        } else if shift.elapsed_s < RAMP_DOWN_PART * shift.duration_s {
            Flow::Leaving(self.gear)
        } else {
            Flow::Open {
                to: shift.to,
                left_s,
            }
        }
    }

    /// Returns the gear to change to, if any.
    fn wanted(&self, truck: &Truck, now: &Situation) -> Option<usize> {
        if self.gear == 0 || self.rested_s < REST_S {
            return None;
        }
        let rpm = |gear: usize| truck.engine_rpm(gear, now.speed_mps);
        let force = |gear: usize| truck.full_load_nm(rpm(gear)) * truck.force_per_torque(gear);
        let own = rpm(self.gear);
        if own > HIGHEST_RPM && self.gear < truck.top_gear() {
            return Some(self.gear + 1);
        }
        if own > FULL_LOAD_RPM || !now.at_full_load {
            let higher = (self.gear + 1..=truck.top_gear())
                .take(LONGEST_STEP)
                .filter(|&gear| rpm(gear) >= AFTER_UPSHIFT_RPM)
                .filter(|&gear| force(gear) >= UPSHIFT_RESERVE * now.resisting_n)
                .last();
            if higher.is_some() {
                return higher;
            }
        }
        let lower = self.gear.checked_sub(1).filter(|&gear| gear > 0)?;
        let losing = now.at_full_load
            && now.acceleration_mps2 < LOSING_MPS2
            && now.speed_mps < now.set_speed_mps - TOLERATED_LOSS_MPS
            && rpm(lower) < AFTER_DOWNSHIFT_RPM
            && force(lower) > DOWNSHIFT_GAIN * force(self.gear);
        let too_slow = own < LOWEST_RPM && own > IDLE_RPM && now.acceleration_mps2 < 0.0;
        (losing || too_slow).then_some(lower)
    }
}

/// Returns the highest gear that keeps the engine above its lowest speed.
#[must_use]
pub fn cruising_gear(truck: &Truck, speed_mps: f64) -> usize {
    (1..=truck.top_gear())
        .rev()
        .find(|&gear| truck.engine_rpm(gear, speed_mps) >= AFTER_UPSHIFT_RPM)
        .unwrap_or(1)
}

/// Returns the highest gear in which half of the idling engine's torque is sufficient to start.
#[must_use]
pub fn launch_gear(truck: &Truck, resistance_n: f64) -> usize {
    let torque_nm = 0.5 * truck.full_load_nm(IDLE_RPM);
    (1..=truck.top_gear())
        .rev()
        .find(|&gear| {
            torque_nm * truck.force_per_torque(gear)
                >= truck.accelerated_kg(0) * LAUNCH_MPS2 + resistance_n
        })
        .unwrap_or(1)
}
