//! F and the noises of a cell, as a pass uses them.

use super::levels::Levels;
use super::variances::{CellVariances, SegmentVariances};
use crate::cell::CELL_LENGTH_M;
use crate::filter::{CellInput, CellNoise, Dynamics, NOISES, Noise};
use crate::scalar::Scalar;
use crate::tuning::Numbers;

/// What is the same in every cell.
#[derive(Clone, Copy, Debug)]
pub struct CellModel<'n> {
    /// Every number.
    pub numbers: &'n Numbers,
    keep_slope_rate: f32,
    keep_bias: f32,
    keep_wind: f32,
}

/// Dynamics, base variances, and variances of a cell.
#[derive(Clone, Copy, Debug)]
pub struct CellTerms<S> {
    /// F.
    pub dynamics: Dynamics<S>,
    /// Variances of the noises before levels, multipliers and shocks.
    pub base: [S; NOISES],
    /// Variances of the noises as the pass uses them.
    pub noise: CellNoise<S>,
}

/// Returns the fraction that a Gauss-Markov process keeps over some correlation lengths.
#[inline(always)]
fn keep(lengths: f32) -> f32 {
    1.0 / (1.0 + lengths)
}

/// Returns what a Gauss-Markov process gains of its stationary variance.
#[inline(always)]
fn gained(keep: f32, variance: f32) -> f32 {
    (1.0 - keep * keep) * variance
}

const fn square(number: f32) -> f32 {
    number * number
}

impl<'n> CellModel<'n> {
    /// Returns the model of the cells.
    #[must_use]
    pub fn new(numbers: &'n Numbers) -> Self {
        Self {
            numbers,
            keep_slope_rate: keep(CELL_LENGTH_M / numbers.slope_rate_length_m),
            keep_bias: keep(CELL_LENGTH_M / numbers.bias_length_m),
            keep_wind: keep(CELL_LENGTH_M / numbers.wind_length_m),
        }
    }

    /// Returns the terms of a cell. `begins_segment` is whether it is the first of its segment.
    #[inline(always)]
    #[must_use]
    pub fn terms<S: Scalar>(
        &self,
        cell: &CellInput,
        own: &CellVariances,
        segment: &SegmentVariances,
        begins_segment: bool,
        levels: &Levels,
    ) -> CellTerms<S> {
        let numbers = self.numbers;
        let keep_slow = keep(cell.duration_s / numbers.slow_gnss_time_s);
        let keep_fast = keep(cell.duration_s / numbers.fast_gnss_time_s);
        let base = self.base(cell, keep_slow, keep_fast);
        let dynamics = Dynamics {
            keep_energy: S::from_f32(cell.keep_energy),
            gravity: S::from_f32(cell.gravity),
            net_traction: S::from_f32(cell.net_traction_percent),
            traction_jump: S::from_f32(cell.traction_jump_percent),
            retarder: S::from_f32(cell.retarder_percent),
            retarder_step: S::from_f32(cell.retarder_step_percent),
            keep_slope_rate: S::from_f32(self.keep_slope_rate),
            keep_bias: S::from_f32(self.keep_bias),
            keep_wind: S::from_f32(self.keep_wind),
            keep_slow_gnss_error: S::from_f32(keep_slow),
            keep_fast_gnss_error: S::from_f32(keep_fast),
            ends_doubt: own.doubt_cell.ends_doubt(),
        };
        let mut of = base;
        of[Noise::Force as usize] *= levels.force;
        of[Noise::Force as usize] += square(cell.gravity) * cell.fixed_force_variance;
        of[Noise::Road as usize] *= levels.road * segment.road;
        of[Noise::SlowGnss as usize] *= levels.slow_gnss * segment.slow_gnss;
        of[Noise::FastGnss as usize] *= levels.fast_gnss;
        of[Noise::Doubt as usize] = own.doubt;
        if cell.marks.receiver_switched {
            of[Noise::SlowGnss as usize] += square(numbers.switched_gnss_noise_m);
        }
        if begins_segment {
            of[Noise::Bias as usize] += segment.bias_shock;
            of[Noise::Kink as usize] = segment.kink;
        }
        CellTerms {
            dynamics,
            base: base.map(S::from_f32),
            noise: CellNoise {
                of: of.map(S::from_f32),
                load: S::from_f32(Scalar::min(segment.load, cell.load_variance)),
                speed: S::from_f32(cell.energy.variance * levels.speed),
                altitude: S::from_f32(
                    cell.altitude.variance * levels.altitude / own.altitude_weight,
                ),
                slope: S::from_f32(cell.slope.variance * levels.slope / own.slope_weight),
            },
        }
    }

    #[inline(always)]
    fn base(&self, cell: &CellInput, keep_slow: f32, keep_fast: f32) -> [f32; NOISES] {
        let numbers = self.numbers;
        let bends = if cell.marks.invalid || cell.marks.by_accelerometer {
            numbers.invalid_road
        } else {
            1.0
        };
        let mut base = [0.0; NOISES];
        base[Noise::Force as usize] = square(cell.gravity) * cell.force_variance;
        base[Noise::Road as usize] =
            bends * gained(self.keep_slope_rate, square(numbers.slope_rate_noise));
        base[Noise::Bias as usize] =
            gained(self.keep_bias, cell.bias_variance) + cell.effect_variance;
        base[Noise::Wind as usize] = gained(self.keep_wind, cell.wind_variance);
        base[Noise::Scale as usize] =
            square(numbers.scale_walk_per_sqrt_km) * CELL_LENGTH_M * 0.001;
        base[Noise::SlowGnss as usize] = gained(keep_slow, square(numbers.slow_gnss_noise_m));
        base[Noise::FastGnss as usize] = gained(keep_fast, square(numbers.fast_gnss_noise_m));
        base
    }
}
