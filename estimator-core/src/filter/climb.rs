//! Climb as GNSS tells it against climb as the vehicle model reads it, over hundreds of metres.
//!
//! A fix that drifts passes any test of single innovations, since the filter follows it. But a road
//! cannot climb by GNSS and not by the forces: over a stretch, the slope that the model read, with
//! the bias, wind and scale that were known where the stretch began, leaves less room than a drift
//! takes.

use super::state::{BIAS, SCALE, State, WIND};
use crate::scalar::Scalar;
use heapless::Deque;

/// Stretches that are remembered, and the length of each, m.
const STRETCHES: usize = 10;
const STRETCH_M: f32 = 100.0;
/// Largest sigma of what bias, wind and scale make of the slope with which the model can judge a
/// receiver, %: where a drive begins, it is the model that is off.
const LARGEST_SIGMA_PERCENT: f32 = 0.25;
/// Error of the model's climb that grows with nothing: reading noise at both ends, m.
const MODEL_SIGMA_M: f32 = 0.1;

/// A stretch: what was known at its start, and the model's climb over it.
#[derive(Clone, Copy, Debug)]
struct Stretch {
    /// Cell before its first.
    cell: u32,
    /// Altitude of the fix there, m, and its variance, m².
    altitude_m: f32,
    variance: f32,
    known: Correction,
    way: Way,
    /// Part of the slow error that is left at its end, once another follows.
    error_kept: Option<f32>,
}

/// What was known, at one place, of how the model errs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Correction {
    /// Grade that it reads too high for long, and as the wind comes and goes, %.
    pub bias_percent: f32,
    pub wind_percent: f32,
    /// Scale error, 1.
    pub scale: f32,
    /// Variance of the slope that they make, %².
    pub slope_variance: f32,
}

impl Correction {
    /// As a state knows it.
    pub(super) fn of<S: Scalar>(state: &State<S>) -> Self {
        let p = |i: usize, j: usize| state.p.get(i, j).to_f32();
        let load = state.load.to_f32();
        let variance = p(BIAS, BIAS)
            + p(WIND, WIND)
            + load * load * p(SCALE, SCALE)
            + 2.0 * (p(BIAS, WIND) - load * (p(BIAS, SCALE) + p(WIND, SCALE)));
        Self {
            bias_percent: state.x[BIAS].to_f32(),
            wind_percent: state.x[WIND].to_f32(),
            scale: state.x[SCALE].to_f32(),
            slope_variance: variance.max(0.0),
        }
    }
}

/// What was driven.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Way {
    /// Length, m.
    pub length_m: f32,
    /// Time, s.
    pub duration_s: f32,
    /// Climb at the slope that the model reads, m.
    pub climb_m: f32,
    /// Climb at the slope that an error of the scale amounts to, m.
    pub load_climb_m: f32,
    /// What the climb may be off where the model does not hold, m.
    pub doubt_m: f32,
}

impl Way {
    /// Part of the slow error that is left at its end.
    fn error_kept(&self, fixed: &Fixed) -> f32 {
        libm::expf(-self.duration_s / fixed.error_time_s)
    }

    /// Followed by another.
    fn and(self, next: Self) -> Self {
        Self {
            length_m: self.length_m + next.length_m,
            duration_s: self.duration_s + next.duration_s,
            climb_m: self.climb_m + next.climb_m,
            load_climb_m: self.load_climb_m + next.load_climb_m,
            doubt_m: self.doubt_m + next.doubt_m,
        }
    }
}

/// An altitude to be compared, and what its errors may be.
#[derive(Clone, Copy, Debug)]
pub(super) struct Fixed {
    /// The fix, m.
    pub altitude_m: f32,
    /// Variance of its white noise, m².
    pub variance: f32,
    /// Variance of the slow error, m², and how long it keeps its value, s.
    pub error_variance: f32,
    pub error_time_s: f32,
    /// Variance of wind, %², and how long it keeps its value, m.
    pub wind_variance: f32,
    pub wind_length_m: f32,
}

/// How far the climbs differ.
#[derive(Clone, Copy, Debug)]
pub(super) struct Misfit {
    /// Squared difference of the climbs over its variance, where that is largest.
    pub normalised: f32,
    /// Its mean over all stretches; one, if all variances are right.
    pub mean: f32,
    /// The cell since which they differ so, and what was known there.
    pub since_cell: u32,
    pub known: Correction,
    /// Length of the longest stretch compared, m.
    pub compared_m: f32,
}

/// The last stretches, oldest first.
#[derive(Clone, Debug, Default)]
pub(super) struct Climb {
    stretches: Deque<Stretch, STRETCHES>,
}

impl Climb {
    /// Forgets all.
    pub(super) fn forget(&mut self) {
        self.stretches.clear();
    }

    /// Goes over a cell.
    pub(super) fn drive(&mut self, way: Way) {
        if let Some(stretch) = self.stretches.back_mut() {
            stretch.way = stretch.way.and(way);
        }
    }

    /// Compares a fix with those that are remembered, from the newest back until `way_m` are
    /// compared.
    pub(super) fn compare(&self, fixed: &Fixed, way_m: f32) -> Option<Misfit> {
        let mut worst: Option<(f32, &Stretch)> = None;
        let mut way = Way::default();
        let mut error_kept = 1.0;
        let (mut sum, mut count) = (0.0, 0.0);
        let (older, newer) = self.stretches.as_slices();
        for stretch in newer.iter().rev().chain(older.iter().rev()) {
            if way.length_m >= way_m {
                break;
            }
            way = stretch.way.and(way);
            error_kept *= stretch
                .error_kept
                .unwrap_or_else(|| stretch.way.error_kept(fixed));
            let normalised = stretch.misfit(&way, error_kept, fixed);
            sum += normalised;
            count += 1.0;
            if worst.is_none_or(|(most, _)| normalised >= most) {
                worst = Some((normalised, stretch));
            }
        }
        worst.map(|(normalised, stretch)| Misfit {
            normalised,
            mean: sum / count,
            since_cell: stretch.cell,
            known: stretch.known,
            compared_m: way.length_m,
        })
    }

    /// Remembers a fix, if the last one that was lies a stretch behind.
    pub(super) fn remember(&mut self, cell: u32, fixed: &Fixed, known: Correction) {
        if known.slope_variance > LARGEST_SIGMA_PERCENT * LARGEST_SIGMA_PERCENT {
            return;
        }
        if let Some(last) = self.stretches.back_mut() {
            if last.way.length_m < STRETCH_M {
                return;
            }
            last.error_kept = Some(last.way.error_kept(fixed));
        }
        if self.stretches.is_full() {
            self.stretches.pop_front();
        }
        // There is room.
        let _ = self.stretches.push_back(Stretch {
            cell,
            altitude_m: fixed.altitude_m,
            variance: fixed.variance,
            known,
            way: Way::default(),
            error_kept: None,
        });
    }
}

impl Stretch {
    /// Squared difference of the climbs over the way from its start to a fix, over its variance.
    fn misfit(&self, way: &Way, error_kept: f32, fixed: &Fixed) -> f32 {
        let known = &self.known;
        let bias_percent = known.bias_percent + known.wind_percent;
        let model_m =
            way.climb_m - 0.01 * bias_percent * way.length_m + known.scale * way.load_climb_m;
        let difference_m = fixed.altitude_m - self.altitude_m - model_m;
        let variance = self.variance + fixed.variance + self.variance_over(way, error_kept, fixed);
        difference_m * difference_m / variance
    }

    /// Variance of the difference of the climbs that grows on the way from its start, m².
    fn variance_over(&self, way: &Way, error_kept: f32, fixed: &Fixed) -> f32 {
        // Of an Ornstein-Uhlenbeck process: 2 σ² (1 − exp(−t/τ)).
        let turned = 1.0 - error_kept;
        // Of the mean of one that begins at a known value, for short ways: ⅔ σ² L/λ.
        let gusts = fixed.wind_variance * Scalar::min(way.length_m / fixed.wind_length_m, 1.0);
        let per_percent = 0.01 * way.length_m;
        2.0 * fixed.error_variance * turned
            + per_percent * per_percent * (self.known.slope_variance + gusts)
            + way.doubt_m * way.doubt_m
            + MODEL_SIGMA_M * MODEL_SIGMA_M
    }
}
