//! A traction force that is late beside the motion.
//!
//! A force that is late or low-passed by τ lacks about τ times its rate of change. The difference
//! from its own low-pass of that time constant is as much; most of it is added. What is wrong with
//! that lasts as long as τ.

use super::low_pass::low_passed;
use crate::scalar::Scalar;

/// Part of the difference that is added, and part of it by which that may be wrong, 1 sigma: a pure
/// delay and a low-pass of the same length differ by so much.
const ADDED: f32 = 0.8;
const WRONG: f32 = 0.7;

/// What the net traction lacks because it is late.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Lack {
    /// To add, %.
    pub percent: f32,
    /// Sigma of white noise of a cell, %.
    pub noise_percent: f32,
}

/// The low-pass of the net traction.
#[derive(Clone, Copy, Debug)]
pub(super) struct LateTraction {
    low_pass_percent: Option<f32>,
}

impl LateTraction {
    pub(super) const fn new() -> Self {
        Self {
            low_pass_percent: None,
        }
    }

    /// Returns what the net traction of a cell lacks, %, if it is late by so many seconds.
    pub(super) fn lack(&mut self, late_s: f32, duration_s: f32, percent: f32) -> Lack {
        if late_s <= 0.0 {
            return Lack::default();
        }
        let before = self.low_pass_percent.unwrap_or(percent);
        let low_pass = low_passed(before, percent, duration_s, late_s);
        self.low_pass_percent = Some(low_pass);
        let behind = percent - low_pass;
        let cells = 1.0 + late_s / Scalar::max(duration_s, 1e-3);
        Lack {
            percent: ADDED * behind,
            noise_percent: WRONG * behind.abs() * Scalar::sqrt(cells),
        }
    }
}
