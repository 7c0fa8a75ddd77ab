//! Climb as GNSS tells it against climb as the vehicle model reads it, over hundreds of metres.
//!
//! A fix that drifts passes any test of single innovations, since the filter follows it. But a road
//! cannot climb by GNSS and not by the forces: over a stretch, the slope that the model read, with
//! the bias, wind and scale that were known where the stretch began, leaves less room than a drift
//! takes.
//!
//! A fix is compared with one remembered place a cell, so that no step takes much longer than
//! another; fixes that come meanwhile are not compared, and say nearly the same.

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
    /// What was known there.
    known: Correction,
    /// Altitude of the fix there, m, and its variance, m².
    altitude_m: f32,
    variance: f32,
    way: Way,
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
            slope_variance: Scalar::max(variance, 0.0),
        }
    }
}

/// What was driven.
#[derive(Clone, Copy, Debug)]
pub(super) struct Way {
    /// Length, m.
    pub length_m: f32,
    /// Part of the slow error that is left at its end.
    pub error_kept: f32,
    /// Climb at the slope that the model reads, m.
    pub climb_m: f32,
    /// Climb at the slope that an error of the scale amounts to, m.
    pub load_climb_m: f32,
    /// What the climb may be off where the model does not hold, m.
    pub doubt_m: f32,
}

impl Way {
    /// None.
    const NONE: Self = Self {
        length_m: 0.0,
        error_kept: 1.0,
        climb_m: 0.0,
        load_climb_m: 0.0,
        doubt_m: 0.0,
    };

    /// Followed by another.
    fn and(self, next: Self) -> Self {
        Self {
            length_m: self.length_m + next.length_m,
            error_kept: self.error_kept * next.error_kept,
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
    /// Variance of the slow error, m².
    pub error_variance: f32,
    /// Variance of wind, %², and over how long it turns, a way, 1/m.
    pub wind_variance: f32,
    pub per_wind_length: f32,
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

/// A fix that is being compared.
#[derive(Clone, Copy, Debug)]
struct Comparison {
    fixed: Fixed,
    /// How far to go back, m.
    way_m: f32,
    /// How far that is done: the way from there to the fix, and its stretches.
    way: Way,
    stretches: u8,
    /// Sum of their misfits, and the worst, with the cell and what was known there.
    sum: f32,
    worst: Option<(f32, u32, Correction)>,
}

/// The last stretches, oldest first.
#[derive(Clone, Debug, Default)]
pub(super) struct Climb {
    stretches: Deque<Stretch, STRETCHES>,
    comparison: Option<Comparison>,
}

impl Climb {
    /// Forgets all.
    pub(super) fn forget(&mut self) {
        self.stretches.clear();
        self.comparison = None;
    }

    /// Goes over a cell.
    pub(super) fn drive(&mut self, way: Way) {
        if let Some(stretch) = self.stretches.back_mut() {
            stretch.way = stretch.way.and(way);
        }
        if let Some(comparison) = &mut self.comparison
            && comparison.goes_on(self.stretches.len())
            && let Some(stretch) = self.stretches.iter().nth_back(comparison.stretches.into())
        {
            comparison.add(stretch);
        }
    }

    /// How an earlier fix compared, once that is known.
    pub(super) fn compared(&mut self) -> Option<Misfit> {
        let misfit = self.comparison.as_ref()?.misfit(self.stretches.len())?;
        self.comparison = None;
        Some(misfit)
    }

    /// Remembers a fix, if the last one that was lies a stretch behind; else begins to compare it
    /// with those, the newest first, until `way_m` are compared. Does neither while another is.
    pub(super) fn take(
        &mut self,
        cell: u32,
        fixed: &Fixed,
        known: impl FnOnce() -> Correction,
        way_m: f32,
    ) {
        if self.comparison.is_some() || self.remember(cell, fixed, known) {
            return;
        }
        if let Some(newest) = self.stretches.back() {
            let comparison = self.comparison.insert(Comparison::new(*fixed, way_m));
            comparison.add(newest);
        }
    }

    fn remember(&mut self, cell: u32, fixed: &Fixed, known: impl FnOnce() -> Correction) -> bool {
        let last = self.stretches.back();
        if last.is_some_and(|last| last.way.length_m < STRETCH_M) {
            return false;
        }
        let known = known();
        if known.slope_variance > LARGEST_SIGMA_PERCENT * LARGEST_SIGMA_PERCENT {
            return false;
        }
        if self.stretches.is_full() {
            self.stretches.pop_front();
        }
        let stretch = Stretch {
            cell,
            known,
            altitude_m: fixed.altitude_m,
            variance: fixed.variance + MODEL_SIGMA_M * MODEL_SIGMA_M,
            way: Way::NONE,
        };
        // There is room.
        self.stretches.push_back(stretch).is_ok()
    }
}

impl Comparison {
    const fn new(fixed: Fixed, way_m: f32) -> Self {
        Self {
            fixed,
            way_m,
            way: Way::NONE,
            stretches: 0,
            sum: 0.0,
            worst: None,
        }
    }

    /// Whether there is another to be compared, of so many.
    fn goes_on(&self, stretches: usize) -> bool {
        usize::from(self.stretches) < stretches && self.way.length_m < self.way_m
    }

    /// The next older stretch.
    #[inline(never)] // Seldom the first of its cell.
    fn add(&mut self, stretch: &Stretch) {
        self.way = stretch.way.and(self.way);
        self.stretches += 1;
        let normalised = stretch.misfit(&self.way, &self.fixed);
        self.sum += normalised;
        if self.worst.is_none_or(|(most, ..)| normalised >= most) {
            self.worst = Some((normalised, stretch.cell, stretch.known));
        }
    }

    fn misfit(&self, stretches: usize) -> Option<Misfit> {
        if self.goes_on(stretches) {
            return None;
        }
        self.worst.map(|(normalised, since_cell, known)| Misfit {
            normalised,
            mean: self.sum / f32::from(self.stretches),
            since_cell,
            known,
            compared_m: self.way.length_m,
        })
    }
}

impl Stretch {
    /// Squared difference of the climbs over the way from its start to a fix, over its variance.
    fn misfit(&self, way: &Way, fixed: &Fixed) -> f32 {
        let known = &self.known;
        let per_percent_m = 0.01 * way.length_m;
        let model_m = way.climb_m - per_percent_m * (known.bias_percent + known.wind_percent)
            + known.scale * way.load_climb_m;
        let difference_m = fixed.altitude_m - self.altitude_m - model_m;
        // Of the mean of one that begins at a known value, for short ways: ⅔ σ² L/λ.
        let gusts = fixed.wind_variance * Scalar::min(way.length_m * fixed.per_wind_length, 1.0);
        let variance = self.variance
            + fixed.variance
            // Of an Ornstein-Uhlenbeck process: 2 σ² (1 − exp(−t/τ)).
            + 2.0 * fixed.error_variance * (1.0 - way.error_kept)
            + per_percent_m * per_percent_m * (known.slope_variance + gusts)
            + way.doubt_m * way.doubt_m;
        difference_m * difference_m / variance
    }
}
