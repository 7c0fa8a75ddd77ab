//! How late the traction force is beside the motion.
//!
//! A change of the force shows in the acceleration at once, and roads bend more slowly than drivers
//! and gearboxes act. So changes of the force over a second correlate with changes of the
//! acceleration, and best at the lag between the two messages: zero on a bus, up to seconds where a
//! logger or a gateway polls them in turn. A speed that is later than the force is smoothed; that is
//! noise, which the filter learns.
//!
//! The changes are taken over slots of equal length. Gear shifts and launches show the lag to a tenth
//! of a second within minutes. A drive without them shows none: what the road changes comes slowly.

use crate::scalar::{Scalar, ln};
use heapless::Vec;

/// Slots in a second, and from one lag to the next.
const SECOND: usize = 4;
const STEP: usize = 2;
/// Length of such a step, s.
const STEP_S: f32 = 0.5;
/// Number of lags, and the index of the lag of zero: from -0.5 to 4 s.
const LAGS: usize = 10;
const AT_ONCE: usize = 1;
/// Age of the acceleration that is compared, in slots.
const CENTRE: usize = 18;
/// Slots that this needs.
pub(super) const SLOTS: usize = CENTRE + STEP * AT_ONCE + SECOND / 2 + 1;
/// Largest changes that count, so that no single launch decides: acceleration, m/s², and force, in
/// units of 10 kN.
const MOST: (f32, f32) = (0.5, 1.0);
/// Slots that count as one, since the changes in them overlap.
const ALIKE: f32 = 6.0;
/// Evidence, the logarithm of a ratio of likelihoods, from which on the force is late, and below
/// which it no longer is.
const ENOUGH: f32 = 6.0;
const TOO_LITTLE: f32 = 1.0;
/// Least correlation at the lag: without gear shifts and launches, all lags are alike.
const CLEAR: f32 = 0.25;
/// Slots between two decisions: 10 s.
const DECIDE_EVERY: u8 = 40;
/// Fewest slots, and decisions in a row, that show a lag: two minutes, and one.
const FEWEST: f32 = 480.0;
const IN_A_ROW: u8 = 6;

/// What the wheels did in a slot, and the force in it, in units of 10 kN.
#[derive(Clone, Copy, Debug)]
pub(super) struct Slot {
    pub wheels_mps: f32,
    pub force: f32,
}

/// The comparison of both.
#[derive(Clone, Debug)]
pub(super) struct TractionLag {
    /// Sums of products of the changes, one a lag. Of a length that compilers do not know, so that
    /// they do not unroll loops.
    products: Vec<f32, LAGS>,
    /// Sums of squares of the changes of acceleration and force, and number of slots.
    accelerations: f32,
    forces: f32,
    count: f32,
    until_decision: u8,
    /// Lag that fits best, and for how many decisions it has.
    best: u8,
    in_a_row: u8,
    late_s: f32,
}

impl TractionLag {
    pub(super) fn new() -> Self {
        Self {
            products: Vec::from_array([0.0; LAGS]),
            accelerations: 0.0,
            forces: 0.0,
            count: 0.0,
            until_decision: DECIDE_EVERY,
            best: AT_ONCE as u8,
            in_a_row: 0,
            late_s: 0.0,
        }
    }

    /// Returns by how much the force is later than the speed, s; zero unless that is certain.
    pub(super) const fn late_s(&self) -> f32 {
        self.late_s
    }

    /// Takes the newest slots, the newest first. Of what is known, each counts for the part `forget`.
    #[inline(never)] // Once a slot.
    pub(super) fn slot(&mut self, slots: &[Slot; SLOTS], crawl_mps: f32, forget: f32) {
        let speed = |age: usize| slots.get(age).map_or(0.0, |slot| slot.wheels_mps);
        let (newer, older) = (speed(CENTRE - SECOND), speed(CENTRE + SECOND));
        // A clutch that slips passes a force that nothing reports.
        if Scalar::min(speed(0), older) < crawl_mps {
            return;
        }
        let acceleration = bounded(newer - 2.0 * speed(CENTRE) + older, MOST.0);
        let keep = 1.0 - forget;
        self.accelerations = keep * self.accelerations + acceleration * acceleration;
        self.count = keep * self.count + 1.0;
        let force = |age: usize| slots.get(age).map_or(0.0, |slot| slot.force);
        let mut age = CENTRE + STEP * AT_ONCE - SECOND / 2;
        let mut change = 0.0;
        for product in &mut self.products {
            let (newer, older) = (force(age), force(age + SECOND));
            // An open clutch passes none. Other messages say so, and at another time.
            change = if newer == 0.0 || older == 0.0 {
                0.0
            } else {
                bounded(newer - older, MOST.1)
            };
            *product = keep * *product + acceleration * change;
            age = age.wrapping_sub(STEP);
        }
        // Of the newest changes: what they multiply is in the other sum already, or still to come.
        self.forces = keep * self.forces + change * change;
        self.until_decision = self.until_decision.saturating_sub(1);
        if self.until_decision == 0 {
            self.until_decision = DECIDE_EVERY;
            let late_s = self.decide().unwrap_or_default();
            self.in_a_row = if late_s > 0.0 {
                self.in_a_row.saturating_add(1)
            } else {
                0
            };
            self.late_s = if self.in_a_row > IN_A_ROW {
                late_s
            } else {
                0.0
            };
        }
    }

    /// Returns the lag that the slots show; `None` if it is none, or another one than last time.
    #[inline(never)] // Rare.
    fn decide(&mut self) -> Option<f32> {
        // Nought where both change the other way.
        let product = |index: usize| Scalar::max(0.0, *self.products.get(index).unwrap_or(&0.0));
        let (mut best, mut most) = (AT_ONCE, product(AT_ONCE));
        for index in 0..self.products.len() {
            if product(index) > most {
                (best, most) = (index, product(index));
            }
        }
        let is_as_before = best.abs_diff(self.best.into()) <= 1;
        self.best = best as u8;
        let largest = self.accelerations * self.forces;
        let left = |product: f32| Scalar::max(1e-3, 1.0 - product * product / largest);
        let evidence = 0.5 * self.count / ALIKE * ln(left(product(AT_ONCE)) / left(most));
        let least = if self.late_s == 0.0 {
            ENOUGH
        } else {
            TOO_LITTLE
        };
        let is_certain = evidence > least && most * most > CLEAR * CLEAR * largest;
        let is_peak = best > AT_ONCE && best + 1 < self.products.len();
        if !is_as_before || !is_certain || !is_peak || self.count < FEWEST {
            return None;
        }
        let (before, after) = (product(best - 1), product(best + 1));
        // Not nought: the middle one is the largest.
        let aside = 0.5 * (after - before) / (2.0 * most - before - after);
        Some(STEP_S * (best as f32 - AT_ONCE as f32 + aside))
    }
}

fn bounded(change: f32, most: f32) -> f32 {
    Scalar::min(most, Scalar::max(-most, change))
}
