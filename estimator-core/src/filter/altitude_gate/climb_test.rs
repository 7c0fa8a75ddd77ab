//! Test of the receiver: climb by GNSS against climb by the vehicle model, over hundreds of metres.
//!
//! A fix that drifts passes every test of single innovations, since the filter follows it. But a
//! road cannot climb by GNSS and not by the forces. Over a longer distance, the slope that the model
//! read, with the bias, wind and scale that were known where that distance began, leaves less room
//! than a drift takes.
//!
//! A fix is compared with one reference fix a cell, so that no step takes much longer than another.
//! Fixes that come meanwhile are not compared; they say nearly the same.

use crate::filter::state::State;
use crate::filter::state_index::StateIndex::{Bias, Scale, Wind};
use crate::scalar::Scalar;
use crate::tuning::Gates;
use heapless::Deque;

/// Number of reference fixes in memory.
const REFERENCES: usize = 10;

/// The error of the vehicle model as it was known at one cell.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::filter) struct ModelError {
    /// Bias state, %.
    pub bias_percent: f32,
    /// Wind state, %.
    pub wind_percent: f32,
    /// Scale error, 1.
    pub scale: f32,
    /// Variance of the slope that they make together, %².
    pub slope_variance: f32,
}

impl ModelError {
    /// Returns the model error that a state holds.
    pub(in crate::filter) fn of<S: Scalar>(state: &State<S>) -> Self {
        let p = |i, j| state.covariance.get(i, j).to_f32();
        let net_traction = state.net_traction.to_f32();
        let variance = p(Bias, Bias)
            + p(Wind, Wind)
            + net_traction * net_traction * p(Scale, Scale)
            + 2.0 * (p(Bias, Wind) - net_traction * (p(Bias, Scale) + p(Wind, Scale)));
        Self {
            bias_percent: state.mean[Bias].to_f32(),
            wind_percent: state.mean[Wind].to_f32(),
            scale: state.mean[Scale].to_f32(),
            slope_variance: Scalar::max(variance, 0.0),
        }
    }
}

/// What the model reads over a driven segment.
#[derive(Clone, Copy, Debug)]
pub(in crate::filter) struct Segment {
    /// Length, m.
    pub length_m: f32,
    /// Part of the coloured GNSS error that is left at its end, 1.
    pub gnss_error_kept: f32,
    /// Climb at the slope that the model reads, m.
    pub climb_m: f32,
    /// Climb at the net traction: what an error of the scale amounts to, m.
    pub traction_climb_m: f32,
    /// Sigma of the climb where the model does not hold, m.
    pub invalid_sigma_m: f32,
    /// Sigma of a descent that a brake may hide, m.
    pub hidden_descent_m: f32,
}

impl Segment {
    /// The segment of no length.
    const EMPTY: Self = Self {
        length_m: 0.0,
        gnss_error_kept: 1.0,
        climb_m: 0.0,
        traction_climb_m: 0.0,
        invalid_sigma_m: 0.0,
        hidden_descent_m: 0.0,
    };

    /// Returns this segment followed by another.
    fn and(self, next: Self) -> Self {
        Self {
            length_m: self.length_m + next.length_m,
            gnss_error_kept: self.gnss_error_kept * next.gnss_error_kept,
            climb_m: self.climb_m + next.climb_m,
            traction_climb_m: self.traction_climb_m + next.traction_climb_m,
            invalid_sigma_m: self.invalid_sigma_m + next.invalid_sigma_m,
            hidden_descent_m: self.hidden_descent_m + next.hidden_descent_m,
        }
    }
}

/// A fix to be tested, with the variances of its errors.
#[derive(Clone, Copy, Debug)]
pub(in crate::filter) struct TestedFix {
    /// Altitude, m.
    pub altitude_m: f32,
    /// Variance of its white noise, m².
    pub variance: f32,
    /// Variance of the coloured error, m².
    pub gnss_error_variance: f32,
    /// Variance of the wind state, %².
    pub wind_variance: f32,
    /// One over the correlation length of the wind, 1/m.
    pub per_wind_length: f32,
}

/// The result of a test.
#[derive(Clone, Copy, Debug)]
pub(super) struct ClimbTestResult {
    /// Largest squared difference of the climbs over its variance, of all references.
    pub test_ratio: f32,
    /// Its mean over all references; one, if all variances are right.
    pub mean: f32,
    /// Cell of the reference with the largest ratio, and the model error known there.
    pub since_cell: u32,
    pub model_error: ModelError,
    /// Difference of the climbs since there, as a slope, %.
    pub slope_percent: f32,
    /// Distance to the oldest reference compared, m.
    pub compared_m: f32,
    /// What is seen if no brake hides a descent.
    pub seen: SeenDifference,
}

/// Differences of the climbs as they are seen, whatever a brake may hide.
#[derive(Clone, Copy, Debug)]
pub(super) struct SeenDifference {
    /// Mean of the squared differences over their variances.
    pub mean: f32,
    /// The largest one, and its difference as a slope, %.
    pub largest: f32,
    pub slope_percent: f32,
}

/// A reference fix, and the segment from it to the next one.
#[derive(Clone, Copy, Debug)]
struct Reference {
    cell: u32,
    model_error: ModelError,
    altitude_m: f32,
    /// Variance of its noise and of the model's, m².
    variance: f32,
    segment: Segment,
}

/// A fix that is being compared with the references, the newest first.
#[derive(Clone, Copy, Debug)]
struct Comparison {
    fix: TestedFix,
    /// Distance over which to compare, m.
    distance_m: f32,
    /// Segment from the oldest reference compared so far to the fix, and number of references.
    segment: Segment,
    references: u8,
    /// Sum of the test ratios, and the largest one.
    sum: f32,
    worst: Option<Contradiction>,
    /// The same if no brake hides a descent, and the slope of the largest one, %.
    seen_sum: f32,
    seen_largest: f32,
    seen_slope_percent: f32,
}

/// How much more a fix climbs than the model.
#[derive(Clone, Copy, Debug)]
struct Difference {
    climb_m: f32,
    /// Its variance if no brake hides a descent, m².
    seen_variance: f32,
    /// Its variance, m².
    variance: f32,
}

/// The comparison with one reference.
#[derive(Clone, Copy, Debug)]
struct Contradiction {
    test_ratio: f32,
    cell: u32,
    model_error: ModelError,
    slope_percent: f32,
}

/// The reference fixes, oldest first, and the comparison under way.
#[derive(Clone, Debug, Default)]
pub(super) struct ClimbTest {
    references: Deque<Reference, REFERENCES>,
    comparison: Option<Comparison>,
}

impl ClimbTest {
    /// Drops all references.
    pub(super) fn clear(&mut self) {
        self.references.clear();
        self.comparison = None;
    }

    /// Advances over a cell.
    pub(super) fn advance(&mut self, segment: Segment) {
        if let Some(reference) = self.references.back_mut() {
            reference.segment = reference.segment.and(segment);
        }
        if let Some(comparison) = &mut self.comparison
            && comparison.goes_on(self.references.len())
            && let Some(reference) = self
                .references
                .iter()
                .nth_back(comparison.references.into())
        {
            comparison.add(reference);
        }
    }

    /// Returns the result for an earlier fix, once it is complete.
    pub(super) fn take_result(&mut self) -> Option<ClimbTestResult> {
        let result = self.comparison.as_ref()?.result(self.references.len())?;
        self.comparison = None;
        Some(result)
    }

    /// Keeps a fix as a reference, if the last one lies a segment behind. Otherwise starts to
    /// compare it with the references over `distance_m`. Does neither while a comparison is under
    /// way.
    #[inline(never)] // Called from two places.
    pub(super) fn add(
        &mut self,
        cell: u32,
        fix: &TestedFix,
        model_error: &dyn Fn() -> ModelError,
        distance_m: f32,
        tuning: &Gates,
    ) {
        if self.comparison.is_some() || self.keep(cell, fix, model_error, tuning) {
            return;
        }
        if let Some(newest) = self.references.back() {
            let comparison = self.comparison.insert(Comparison::new(*fix, distance_m));
            comparison.add(newest);
        }
    }

    fn keep(
        &mut self,
        cell: u32,
        fix: &TestedFix,
        model_error: &dyn Fn() -> ModelError,
        tuning: &Gates,
    ) -> bool {
        let last = self.references.back();
        if last.is_some_and(|last| last.segment.length_m < tuning.drift_segment_m) {
            return false;
        }
        let model_error = model_error();
        let largest = tuning.drift_slope_sigma_percent;
        if model_error.slope_variance > largest * largest {
            return false;
        }
        if self.references.is_full() {
            self.references.pop_front();
        }
        let model_sigma_m = tuning.drift_model_sigma_m;
        let reference = Reference {
            cell,
            model_error,
            altitude_m: fix.altitude_m,
            variance: fix.variance + model_sigma_m * model_sigma_m,
            segment: Segment::EMPTY,
        };
        // There is room.
        self.references.push_back(reference).is_ok()
    }
}

impl Comparison {
    const fn new(fix: TestedFix, distance_m: f32) -> Self {
        Self {
            fix,
            distance_m,
            segment: Segment::EMPTY,
            references: 0,
            sum: 0.0,
            worst: None,
            seen_sum: 0.0,
            seen_largest: 0.0,
            seen_slope_percent: 0.0,
        }
    }

    /// Returns whether another one of so many references is to be compared.
    fn goes_on(&self, references: usize) -> bool {
        usize::from(self.references) < references && self.segment.length_m < self.distance_m
    }

    /// Compares the fix with the next older reference.
    #[inline(never)] // Called twice, and rarely in the same cell.
    fn add(&mut self, reference: &Reference) {
        self.segment = reference.segment.and(self.segment);
        self.references += 1;
        let Difference {
            climb_m,
            seen_variance,
            variance,
        } = reference.difference(&self.segment, &self.fix);
        let squared = climb_m * climb_m;
        let slope_percent = 100.0 * climb_m / self.segment.length_m;
        let seen_ratio = squared / seen_variance;
        self.seen_sum += seen_ratio;
        if seen_ratio >= self.seen_largest {
            self.seen_largest = seen_ratio;
            self.seen_slope_percent = slope_percent;
        }
        let test_ratio = squared / variance;
        self.sum += test_ratio;
        if self
            .worst
            .is_none_or(|worst| test_ratio >= worst.test_ratio)
        {
            self.worst = Some(Contradiction {
                test_ratio,
                cell: reference.cell,
                model_error: reference.model_error,
                slope_percent,
            });
        }
    }

    fn result(&self, references: usize) -> Option<ClimbTestResult> {
        if self.goes_on(references) {
            return None;
        }
        let references = f32::from(self.references);
        self.worst.map(|worst| ClimbTestResult {
            test_ratio: worst.test_ratio,
            mean: self.sum / references,
            since_cell: worst.cell,
            model_error: worst.model_error,
            slope_percent: worst.slope_percent,
            compared_m: self.segment.length_m,
            seen: SeenDifference {
                mean: self.seen_sum / references,
                largest: self.seen_largest,
                slope_percent: self.seen_slope_percent,
            },
        })
    }
}

impl Reference {
    /// Returns the difference of the climbs over the segment from here to a fix.
    fn difference(&self, segment: &Segment, fix: &TestedFix) -> Difference {
        let model_error = &self.model_error;
        let per_percent_m = 0.01 * segment.length_m;
        let model_m = segment.climb_m
            - per_percent_m * (model_error.bias_percent + model_error.wind_percent)
            + model_error.scale * segment.traction_climb_m;
        let difference_m = fix.altitude_m - self.altitude_m - model_m;
        let hidden_m = Scalar::min(segment.hidden_descent_m, Scalar::max(-difference_m, 0.0));
        // Variance of the mean of a Gauss-Markov process that begins at a known value, for short
        // segments: 2/3 σ² L/λ, taken as σ² L/λ and at most σ².
        let wind_change =
            fix.wind_variance * Scalar::min(segment.length_m * fix.per_wind_length, 1.0);
        let seen_variance = self.variance
            + fix.variance
            // Of an Ornstein-Uhlenbeck process: 2 σ² (1 − exp(−t/τ)).
            + 2.0 * fix.gnss_error_variance * (1.0 - segment.gnss_error_kept)
            + per_percent_m * per_percent_m * (model_error.slope_variance + wind_change)
            + segment.invalid_sigma_m * segment.invalid_sigma_m;
        Difference {
            climb_m: difference_m,
            seen_variance,
            variance: seen_variance + hidden_m * hidden_m,
        }
    }
}
