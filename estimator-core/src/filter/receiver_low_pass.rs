//! The low-pass of a receiver that smooths its altitudes.
//!
//! The force balance gives the climb x of the vehicle. Altitudes y that the receiver smooths lag behind
//! it. The cross-covariance of two signals without a lag is symmetric, whatever noise they have:
//! E[y x₋] = E[x y₋], where x₋ and y₋ are past values. The sign of the difference says which signal
//! lags. The climb passes low-passes of several time constants; at that of the receiver, the
//! difference is zero. A likelihood of residuals is biased: a low-pass takes noise off the climb, and
//! that alone explains altitudes better.
//!
//! Once a time constant is certain, the low-pass is inverted.

use super::cell_input::{CellInput, Reading};
use super::low_pass::low_passed;
use crate::cell::CELL_LENGTH_M;
use crate::delay::{BestFit, Delay};
use crate::scalar::{Scalar, ln};
use crate::tuning::Detection;

/// Time constants that are compared: 0 to 39 s. One below the second one is none.
const CONSTANTS: usize = 14;
const STEP_S: f32 = 3.0;
/// Time over which means are taken off altitude and climb, s: errors of both are slower.
const MEAN_S: f32 = 30.0;
/// Time over which past values are averaged, s.
const PAST_S: f32 = 5.0;
/// Time until the low-passes have forgotten their beginning, s.
const BEGINNING_S: f32 = 25.0;
/// Largest part of that time in which the force balance does not hold.
const MOST_INVALID: f32 = 0.3;
/// Time of the comparisons that make one block, s: blocks are independent.
const BLOCK_S: f32 = 10.0;
/// Fewest blocks for a decision.
const FEWEST_BLOCKS: f32 = 3.0;
/// Shortest time between two altitudes that are compared, and between two that are inverted, s.
const LEAST_APART_S: f32 = 0.75;
/// Longest time between two altitudes of one low-pass, s.
const MOST_APART_S: f32 = 10.0;
/// Climb from which on it is counted anew, m: single precision.
const MOST_CLIMB_M: f32 = 1_000.0;

/// A height, m, less its mean, and past values of that.
#[derive(Clone, Copy, Debug, Default)]
struct Centred {
    mean_m: f32,
    value_m: f32,
    past_m: f32,
}

impl Centred {
    /// Takes a height, so long after the last one; the first one after a gap.
    fn take(&mut self, height_m: f32, since_s: f32, begins: bool) {
        if begins {
            *self = Self {
                mean_m: height_m,
                ..Self::default()
            };
            return;
        }
        self.mean_m = low_passed(self.mean_m, height_m, since_s, MEAN_S);
        self.value_m = height_m - self.mean_m;
        self.past_m = low_passed(self.past_m, self.value_m, since_s, PAST_S);
    }
}

/// The climb behind the low-pass of one time constant, beside the altitude.
#[derive(Clone, Copy, Debug, Default)]
struct Lagging {
    height_m: f32,
    climb: Centred,
    /// How much later the altitude is: sums of the open block, of all, and of their squares.
    block: f32,
    sum: f32,
    squares: f32,
}

impl Lagging {
    /// Returns the evidence, of so many blocks, that the altitude is later, or earlier: the logarithm
    /// of a ratio of likelihoods, with a negative sign if it is earlier.
    fn evidence(&self, blocks: f32) -> f32 {
        let unexplained = 1.0 - self.sum * self.sum / (blocks * self.squares);
        let evidence = -0.5 * blocks * ln(Scalar::max(unexplained, f32::EPSILON));
        if self.sum > 0.0 { evidence } else { -evidence }
    }

    /// Returns the sigma of the sum.
    fn sigma(&self, blocks: f32) -> f32 {
        Scalar::sqrt(Scalar::max(
            0.0,
            self.squares - self.sum * self.sum / blocks,
        ))
    }
}

/// Climb and altitudes of a drive, and the time constant that they show.
#[derive(Clone, Debug)]
pub(super) struct ReceiverLowPass {
    delay: Delay,
    /// Whether it stays as it is.
    is_given: bool,
    /// Height by the forces, m.
    climb_m: f32,
    lagging: [Lagging; CONSTANTS],
    altitude: Centred,
    /// Part of the last time in which the force balance did not hold.
    invalid: f32,
    /// Time since the low-passes began, since the last altitude, and of the open block, s.
    duration_s: f32,
    since_altitude_s: f32,
    block_s: f32,
    blocks: f32,
    /// The last altitude that was inverted, m, and the time since, s.
    last_m: Option<f32>,
    since_last_s: f32,
}

impl ReceiverLowPass {
    #[inline(always)] // See Estimator::new_in().
    pub fn new() -> Self {
        Self {
            delay: Delay::Unestimated,
            is_given: false,
            climb_m: 0.0,
            lagging: [Lagging::default(); CONSTANTS],
            altitude: Centred::default(),
            invalid: 0.0,
            duration_s: 0.0,
            since_altitude_s: f32::INFINITY,
            block_s: 0.0,
            blocks: 0.0,
            last_m: None,
            since_last_s: 0.0,
        }
    }

    /// Starts with what an earlier drive found.
    pub const fn resume(&mut self, delay: Delay) {
        self.delay = delay;
    }

    /// Takes a time constant, which stays as it is.
    pub const fn keep(&mut self, delay: Delay) {
        self.delay = delay;
        self.is_given = true;
    }

    pub const fn delay(&self) -> Delay {
        self.delay
    }

    /// Takes a cell, with the kinetic energy before and behind it. Inverts the altitude in it.
    #[inline(never)] // One copy: flash is small.
    pub fn follow(&mut self, tuning: &Detection, energies: (f32, f32), cell: &mut CellInput) {
        if cell.marks.receiver_switched && !self.is_given {
            *self = Self::new();
        }
        if cell.marks.gap || cell.marks.receiver_switched {
            self.duration_s = 0.0;
            self.since_altitude_s = f32::INFINITY;
            self.last_m = None;
        }
        self.since_last_s += cell.duration_s;
        if !self.is_given {
            self.climb(energies, cell);
        }
        if !cell.altitude.is_some() {
            return;
        }
        if !self.is_given && self.since_altitude_s > LEAST_APART_S {
            self.compare(tuning, cell);
        }
        if let Delay::Estimated { delay_s, sigma_s } = self.delay
            && delay_s >= STEP_S
        {
            cell.altitude = self.inverted(delay_s, sigma_s, &cell.altitude);
        }
    }

    /// Adds the climb of a cell: what the work of all forces leaves of the kinetic energy.
    fn climb(&mut self, energies: (f32, f32), cell: &CellInput) {
        let duration_s = cell.duration_s;
        self.duration_s += duration_s;
        self.since_altitude_s += duration_s;
        let climb_m = if cell.marks.invalid || cell.marks.gap {
            duration_s * self.rate_mps(1)
        } else {
            0.01 * CELL_LENGTH_M * cell.read_percent(energies)
        };
        let is_invalid = f32::from(u8::from(cell.marks.invalid));
        self.invalid = low_passed(self.invalid, is_invalid, duration_s, BEGINNING_S);
        let base_m = if self.climb_m.abs() > MOST_CLIMB_M {
            self.climb_m
        } else {
            0.0
        };
        self.climb_m += climb_m - base_m;
        for (index, lagging) in self.lagging.iter_mut().enumerate() {
            lagging.height_m -= base_m;
            lagging.climb.mean_m -= base_m;
            lagging.height_m = low_passed(
                lagging.height_m,
                self.climb_m,
                duration_s,
                constant_s(index),
            );
        }
    }

    /// Returns how fast the height rises behind a low-pass, m/s. Without one it is that behind the
    /// shortest: a speed is noisy.
    fn rate_mps(&self, index: usize) -> f32 {
        let index = index.max(1);
        let height_m = self.lagging.get(index).map_or(0.0, |of| of.height_m);
        (self.climb_m - height_m) / constant_s(index)
    }

    /// Compares an altitude with the heights, at the time that it was taken.
    fn compare(&mut self, tuning: &Detection, cell: &CellInput) {
        let since_s = core::mem::replace(&mut self.since_altitude_s, 0.0);
        let begins = since_s > MOST_APART_S;
        if begins {
            self.duration_s = 0.0;
        }
        let age_s = cell.altitude_behind_m / Scalar::max(1.0, cell.speed_mps);
        self.altitude.take(cell.altitude.value, since_s, begins);
        let counts = self.duration_s > BEGINNING_S && self.invalid < MOST_INVALID;
        for index in 0..CONSTANTS {
            let rate_mps = self.rate_mps(index);
            let altitude = self.altitude;
            let Some(lagging) = self.lagging.get_mut(index) else {
                continue;
            };
            let height_m = lagging.height_m - age_s * rate_mps;
            lagging.climb.take(height_m, since_s, begins);
            if counts {
                let climb = &lagging.climb;
                lagging.block += altitude.value_m * climb.past_m - climb.value_m * altitude.past_m;
            }
        }
        if counts {
            self.block_s += since_s;
        }
        if self.block_s > BLOCK_S {
            self.block_s = 0.0;
            self.end_block(tuning.delay_memory_s);
            self.decide(tuning.delay_evidence);
        }
    }

    fn end_block(&mut self, memory_s: f32) {
        let keep = 1.0 - Scalar::min(1.0, BLOCK_S / memory_s);
        self.blocks = keep * self.blocks + 1.0;
        for lagging in &mut self.lagging {
            let block = core::mem::take(&mut lagging.block);
            lagging.sum = keep * lagging.sum + block;
            lagging.squares = keep * lagging.squares + block * block;
        }
    }

    /// Decides on the time constant. `enough` is the evidence that there is one.
    fn decide(&mut self, enough: f32) {
        if self.blocks < FEWEST_BLOCKS {
            return;
        }
        let evidence_at = |constant_s: f32| {
            let at = self.lagging.get((constant_s / STEP_S + 0.5) as usize);
            at.map_or(f32::INFINITY, |at| at.evidence(self.blocks))
        };
        let held_s = self.delay.estimated_s();
        let evidence_against = held_s.map_or(0.0, |held_s| evidence_at(held_s).abs());
        let best = self.crossing();
        let decided = self
            .delay
            .decided(best, evidence_at(0.0), evidence_against, enough);
        let is_short = decided.estimated_s().is_some_and(|of| of < STEP_S);
        self.delay = if is_short {
            Delay::Unestimated
        } else {
            decided
        };
    }

    /// Returns the time constant at which neither altitude nor climb lags.
    fn crossing(&self) -> BestFit {
        let pairs = self.lagging.windows(2).enumerate();
        for (index, pair) in pairs {
            if let [late, early] = pair
                && late.sum > 0.0
                && early.sum <= 0.0
            {
                let apart = late.sum - early.sum;
                return BestFit {
                    delay_s: constant_s(index) + STEP_S * late.sum / apart,
                    sigma_s: STEP_S * late.sigma(self.blocks) / apart,
                    is_clear: true,
                };
            }
        }
        BestFit {
            delay_s: f32::INFINITY,
            sigma_s: f32::INFINITY,
            is_clear: false,
        }
    }

    /// Returns an altitude before the low-pass of a time constant.
    fn inverted(&mut self, constant_s: f32, sigma_s: f32, altitude: &Reading) -> Reading {
        let since_s = self.since_last_s;
        if self.last_m.is_some() && since_s < LEAST_APART_S {
            return Reading::NONE;
        }
        self.since_last_s = 0.0;
        let before_m = self.last_m.replace(altitude.value);
        let Some(before_m) = before_m.filter(|_| since_s < MOST_APART_S) else {
            return Reading::NONE;
        };
        let part = 1.0 - libm::expf(-since_s / constant_s);
        let value = before_m + (altitude.value - before_m) / part;
        let sigma_m = sigma_s / constant_s * (value - altitude.value);
        Reading {
            value,
            variance: altitude.variance + sigma_m * sigma_m,
        }
    }
}

const fn constant_s(index: usize) -> f32 {
    STEP_S * index as f32
}
