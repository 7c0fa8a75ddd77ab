//! The stops and sections of one drive, step by step.

use super::driver::SET_SPEED_MPS;
use super::manoeuvre_file::{Section, Stop};
use std::collections::VecDeque;

/// Deceleration with which the driver plans a stop, m/s², and the time to build it up, s.
const PLANNED: (f64, f64) = (0.7, 0.5);
/// Speed and acceleration of reversing, m/s and m/s².
const REVERSE: (f64, f64) = (1.5, 0.3);
/// Time at standstill before reversing, s, and before its end at which the gear is engaged, s.
const BEFORE_REVERSE_S: (f64, f64) = (6.0, 2.0);

/// What the driver does in a step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Order {
    /// Drives with the cruise control.
    Drive,
    /// Brakes to standstill.
    Halt,
    /// Stands with the parking brake set.
    Stand {
        /// Speed at which something carries the vehicle along the road, m/s.
        carried_mps: f64,
        /// True if the reverse gear is engaged.
        in_reverse: bool,
    },
    /// Reverses.
    Reverse {
        /// Speed, m/s, positive.
        speed_mps: f64,
        /// Acceleration, m/s², positive if the speed grows.
        acceleration_mps2: f64,
    },
}

#[derive(Clone, Copy, Debug)]
enum Phase {
    Driving,
    Halting,
    BeforeReverse { left_s: f64 },
    Reversing { left_m: f64, speed_mps: f64 },
    Standing { left_s: f64 },
}

/// The stops ahead, and how far the next one is done.
#[derive(Clone, Debug)]
pub struct Stops {
    ahead: VecDeque<Stop>,
    phase: Phase,
}

impl Stops {
    /// Creates the stops of a drive that begins at a place, m; those before it are left out.
    #[must_use]
    pub fn new(stops: &[Stop], from_m: f64) -> Self {
        Self {
            ahead: stops
                .iter()
                .copied()
                .filter(|stop| stop.at_m > from_m)
                .collect(),
            phase: Phase::Driving,
        }
    }

    /// Returns the true mass that the vehicle has after the present stop, kg, if it changes.
    #[must_use]
    pub fn mass_kg(&self) -> Option<f64> {
        match self.phase {
            Phase::Standing { .. } => self.ahead.front()?.mass_kg,
            _ => None,
        }
    }

    /// Advances by `step_s`. Returns what the driver does in this step.
    pub fn order(&mut self, distance_m: f64, speed_mps: f64, step_s: f64) -> Order {
        let Some(&stop) = self.ahead.front() else {
            return Order::Drive;
        };
        match &mut self.phase {
            Phase::Driving => {
                let (deceleration, lag_s) = PLANNED;
                let braking_m = speed_mps * (lag_s + 0.5 * speed_mps / deceleration);
                if distance_m + braking_m < stop.at_m {
                    return Order::Drive;
                }
                self.phase = Phase::Halting;
                Order::Halt
            }
            Phase::Halting if speed_mps > 0.0 => Order::Halt,
            Phase::Halting => {
                self.phase = if stop.reverse_m > 0.0 {
                    Phase::BeforeReverse {
                        left_s: BEFORE_REVERSE_S.0,
                    }
                } else {
                    Phase::Standing {
                        left_s: stop.seconds,
                    }
                };
                standing(0.0, false)
            }
            Phase::BeforeReverse { left_s } => {
                *left_s -= step_s;
                let in_reverse = *left_s < BEFORE_REVERSE_S.1;
                if *left_s <= 0.0 {
                    self.phase = Phase::Reversing {
                        left_m: stop.reverse_m,
                        speed_mps: 0.0,
                    };
                }
                standing(0.0, in_reverse)
            }
            Phase::Reversing { left_m, speed_mps } => {
                let order = reversing(left_m, speed_mps, step_s);
                if *speed_mps <= 0.0 {
                    self.phase = Phase::Standing {
                        left_s: stop.seconds,
                    };
                }
                order
            }
            Phase::Standing { left_s } => {
                *left_s -= step_s;
                if *left_s <= 0.0 {
                    self.phase = Phase::Driving;
                    self.ahead.pop_front();
                }
                standing(stop.carried_m / stop.seconds, false)
            }
        }
    }
}

const fn standing(carried_mps: f64, in_reverse: bool) -> Order {
    Order::Stand {
        carried_mps,
        in_reverse,
    }
}

/// Returns the order for a step of reversing, and advances what is left and the speed.
fn reversing(left_m: &mut f64, speed_mps: &mut f64, step_s: f64) -> Order {
    let (highest, acceleration) = REVERSE;
    let before_mps = *speed_mps;
    let must_brake = *left_m <= 0.5 * before_mps * before_mps / acceleration;
    let after_mps = if must_brake {
        (before_mps - acceleration * step_s).max(0.0)
    } else {
        (before_mps + acceleration * step_s).min(highest)
    };
    *left_m -= 0.5 * step_s * (before_mps + after_mps);
    *speed_mps = after_mps;
    Order::Reverse {
        speed_mps: before_mps,
        acceleration_mps2: (after_mps - before_mps) / step_s,
    }
}

/// What the sections at one place add up to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Here {
    /// Factor on the rolling resistance.
    pub rolling_factor: f64,
    /// Additional headwind, m/s.
    pub headwind_mps: f64,
    /// Engine torque of a power take-off, Nm.
    pub pto_nm: f64,
    /// Ratio of the transfer case.
    pub range_ratio: f64,
    /// Set speed, m/s.
    pub set_speed_mps: f64,
    /// True if the retarder is used.
    pub retarder: bool,
}

impl Here {
    /// Returns what holds at a place, m.
    #[must_use]
    pub fn at(sections: &[Section], distance_m: f64) -> Self {
        let plain = Self {
            rolling_factor: 1.0,
            headwind_mps: 0.0,
            pto_nm: 0.0,
            range_ratio: 1.0,
            set_speed_mps: SET_SPEED_MPS,
            retarder: false,
        };
        sections
            .iter()
            .filter(|section| (section.from_m..section.to_m).contains(&distance_m))
            .fold(plain, |sum, section| Self {
                rolling_factor: sum.rolling_factor * section.rolling_factor,
                headwind_mps: sum.headwind_mps + section.headwind_mps,
                pto_nm: sum.pto_nm + section.pto_nm,
                range_ratio: sum.range_ratio * section.range_ratio,
                set_speed_mps: section
                    .set_speed_mps
                    .map_or(sum.set_speed_mps, |speed| speed.min(sum.set_speed_mps)),
                retarder: sum.retarder || section.retarder,
            })
    }
}
