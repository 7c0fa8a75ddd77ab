//! Errors of the wheel radius: GNSS speed against wheel speed.
//!
//! A wrong radius hardly changes the slope, but it changes every speed. The two speeds are compared
//! where the vehicle neither accelerates nor brakes, since their ages differ.

use super::drive::LoggedDrive;
use super::findings::Finding;
use super::rivals::ADOPTED;
use estimator_core::effect::wheel_radius;
use estimator_core::{AdoptedEffect, CELL_LENGTH_M, Effect};

/// Slowest speed of the comparison, m/s.
const SLOWEST_MPS: f32 = 8.0;
/// Largest change of a steady speed over the last cells, m/s.
const STEADY_MPS: f32 = 0.15;
const STEADY_CELLS: usize = 10;
/// Length of a block, m. Means of blocks count as independent.
const BLOCK_M: f64 = 2_000.0;
/// Standard deviation of the comparison itself: latency, slip, climb of the road.
const FLOOR: f64 = 5e-4;

/// Correction of the wheel radius from GNSS speed.
#[derive(Clone, Copy, Debug)]
pub struct Wheels {
    /// True over assumed radius, less one.
    pub amount: f64,
    /// Its sigma.
    pub sigma: f64,
}

impl Wheels {
    /// Estimates the correction from all drives; `None` with fewer than three blocks.
    #[must_use]
    pub fn measured(drives: &[LoggedDrive]) -> Option<Self> {
        let blocks: Vec<f64> = drives.iter().flat_map(blocks).collect();
        if blocks.len() < 3 {
            return None;
        }
        let count = blocks.len() as f64;
        let mean = blocks.iter().sum::<f64>() / count;
        let square = blocks.iter().map(|b| (b - mean).powi(2)).sum::<f64>();
        let sigma = (square / (count - 1.0) / count).sqrt().hypot(FLOOR);
        Some(Self {
            amount: mean,
            sigma,
        })
    }

    /// Returns twice the logarithm of the Bayes factor against the assumed radius.
    #[must_use]
    pub fn evidence(&self) -> f64 {
        let typical = f64::from(wheel_radius::EFFECT.typical).powi(2);
        let own = self.sigma.powi(2);
        self.amount.powi(2) / own * typical / (typical + own) - (1.0 + typical / own).ln()
    }

    /// Returns the correction as an effect.
    #[must_use]
    pub fn adopted(&self) -> AdoptedEffect {
        static EFFECT: &Effect = &wheel_radius::EFFECT;
        AdoptedEffect::new(EFFECT, self.amount as f32, self.sigma as f32)
    }

    /// Returns the effect if the evidence is enough to adopt it.
    #[must_use]
    pub fn finding(&self) -> Option<Finding> {
        (self.evidence() >= ADOPTED).then(|| Finding {
            adopted: self.adopted(),
            evidence: self.evidence(),
            group: Vec::new(),
            pairs: Vec::new(),
            fitted: None,
        })
    }
}

/// Returns the mean of GNSS speed over wheel speed, less one, in each block of a drive.
fn blocks(drive: &LoggedDrive) -> Vec<f64> {
    let mut blocks = Vec::new();
    let (mut sum, mut count, mut length_m) = (0.0, 0.0, 0.0);
    let mut last = None;
    for window in drive.samples.windows(STEADY_CELLS) {
        let (first, sample) = (&window[0], &window[STEADY_CELLS - 1]);
        length_m += f64::from(CELL_LENGTH_M);
        let gnss_mps = sample.effect_inputs.gnss_speed_mps.get();
        // A fix counts once.
        let is_new = gnss_mps.is_some() && gnss_mps != last;
        last = gnss_mps;
        let mps = sample.end.speed_mps;
        let steady = (mps - first.end.speed_mps).abs() < STEADY_MPS && mps > SLOWEST_MPS;
        if let Some(gnss_mps) = gnss_mps.filter(|_| is_new && steady) {
            sum += f64::from(gnss_mps / mps) - 1.0;
            count += 1.0;
        }
        if length_m >= BLOCK_M {
            if count > 5.0 {
                blocks.push(sum / count);
            }
            (sum, count, length_m) = (0.0, 0.0, 0.0);
        }
    }
    blocks
}
