//! The one place where variances are inferred.
//!
//! Each noise is Student-t: given its variance it is normal, and the variance has an inverse gamma
//! prior of shape a and scale g². The fixed point is MacKay's, Q ← (a g² + ½ Q² ρ²) / (a + ½ + ½ Q n),
//! with ρ and n of the backward pass. Where it rests, the posterior p(y|Q) p(Q) is stationary. Plain
//! expectation maximisation has the same stationary points and takes ten times as many rounds.
//!
//! Source: D. J. C. MacKay, "Bayesian interpolation", Neural Computation 4:415, 1992; M. E. Tipping,
//! "Sparse Bayesian learning and the relevance vector machine", Journal of Machine Learning Research
//! 1:211, 2001; for the step that is not open yet P. de Jong and J. Penzer, "Diagnosing shocks in time
//! series", Journal of the American Statistical Association 93:796, 1998.

use super::cell_model::CellTerms;
use super::levels::{LevelSum, LevelSums, Levels};
use super::variances::{CellVariances, SegmentVariances};
use crate::filter::{CellInput, Disturbances, Noise, Score};
use crate::scalar::Scalar;
use crate::tuning::Numbers;

/// Growth of a variance in a round up to which it is extrapolated.
const LARGEST_GROWTH: f32 = 4.0;

/// A step that the variances do not allow yet.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ClosedStep {
    /// Segment at whose start it is.
    pub segment: usize,
    /// ρ²/n, or the odds of the step.
    pub evidence: f32,
    /// Its size ρ/n, %.
    pub size_percent: f32,
}

/// What one backward pass gathers.
#[derive(Clone, Debug, Default)]
pub struct FixedPoint {
    /// Sums behind the levels.
    pub sums: LevelSums,
    /// Largest closed step of the bias.
    pub bias_step: ClosedStep,
    /// Largest closed kink of the road.
    pub kink: ClosedStep,
    /// The most likely closed step of the bias, with its odds as the evidence.
    pub likeliest: ClosedStep,
    /// Sum of the odds over all segments.
    pub odds: f32,
    road: LevelSum,
    slow_gnss: LevelSum,
}

/// A cell and its variances, as the pass goes over it.
#[derive(Debug)]
pub struct PassedCell<'a, S> {
    /// The cell.
    pub cell: &'a CellInput,
    /// Its own variances.
    pub own: &'a mut CellVariances,
    /// The variances of its segment.
    pub segment: &'a mut SegmentVariances,
    /// Number of the segment.
    pub segment_number: usize,
    /// Whether it is the first cell of the segment, the last one that the pass reaches.
    pub begins_segment: bool,
    /// What the pass used.
    pub terms: &'a CellTerms<S>,
    /// What the pass found.
    pub found: &'a Disturbances<S>,
}

impl FixedPoint {
    /// Infers the variances of a cell anew, and those of its segment where it begins.
    pub fn infer<S: Scalar>(
        &mut self,
        numbers: &Numbers,
        levels: &Levels,
        passed: &mut PassedCell<'_, S>,
    ) {
        self.add_levels(levels, passed);
        self.infer_weights(numbers, levels, passed);
        let PassedCell {
            cell,
            own,
            segment,
            terms,
            found,
            ..
        } = passed;
        let step_percent = own.doubt_cell.step_percent;
        if step_percent > 0.0 {
            let score = &found.of[Noise::Doubt as usize];
            own.doubt = shock(numbers.shock_shape, step_percent, own.doubt, score);
        }
        if cell.load_variance > 0.0 {
            segment.load = load_change(numbers, cell, terms.noise.load.to_f32(), &found.load);
        }
        if passed.begins_segment {
            self.infer_segment(numbers, passed);
        }
    }

    /// Adds to the sums behind levels and multipliers.
    fn add_levels<S: Scalar>(&mut self, levels: &Levels, passed: &PassedCell<'_, S>) {
        let PassedCell {
            cell,
            segment,
            terms,
            found,
            ..
        } = passed;
        // The square of the smoothed noise over its base variance, and its determined part.
        let squares = |noise: Noise| {
            let at = noise as usize;
            let (q, score) = (terms.noise.of[at], &found.of[at]);
            let base = terms.base[at];
            if base <= S::ZERO {
                return (0.0, 0.0);
            }
            let squares = (q * score.sum).squared() / base;
            (squares.to_f32(), (q * score.information).to_f32())
        };
        let (square, determined) = squares(Noise::Road);
        self.road.add(square / levels.road, determined);
        self.sums.road.add(square / segment.road, determined);
        if !cell.marks.receiver_switched {
            let (square, determined) = squares(Noise::SlowGnss);
            self.slow_gnss.add(square / levels.slow_gnss, determined);
            self.sums
                .slow_gnss
                .add(square / segment.slow_gnss, determined);
        }
        let (square, determined) = squares(Noise::FastGnss);
        self.sums.fast_gnss.add(square, determined);
        if cell.marks.invalid {
            return;
        }
        // The part of the force's noise that its level multiplies.
        let at = Noise::Force as usize;
        let own = terms.base[at] * S::from_f32(levels.force);
        let part = (own / terms.noise.of[at]).to_f32();
        let (square, determined) = squares(Noise::Force);
        self.sums.force.add(square * part * part, determined * part);
        if let Some(score) = &found.speed
            && !cell.marks.crawling
        {
            let variance = terms.noise.speed;
            let square = (variance * score.sum).squared().to_f32() / cell.energy.variance;
            let determined = (variance * score.information).to_f32();
            self.sums.speed.add(square, determined);
        }
    }

    /// Infers the weights of a fix, and of a slope that was measured directly.
    fn infer_weights<S: Scalar>(
        &mut self,
        numbers: &Numbers,
        levels: &Levels,
        passed: &mut PassedCell<'_, S>,
    ) {
        let PassedCell {
            cell,
            own,
            terms,
            found,
            ..
        } = passed;
        let freedom = numbers.freedom;
        if let Some(score) = &found.altitude {
            let square = expected_square(terms.noise.altitude, score);
            let (base, level) = (cell.altitude.variance, levels.altitude);
            own.altitude_weight = (freedom + 1.0) / (freedom + square / (base * level));
            let weighted = square * own.altitude_weight / base;
            self.sums.altitude.add(weighted, 1.0);
        }
        if let Some(score) = &found.slope {
            let square = expected_square(terms.noise.slope, score);
            let (base, level) = (cell.slope.variance, levels.slope);
            own.slope_weight = (freedom + 1.0) / (freedom + square / (base * level));
            let weighted = square * own.slope_weight / base;
            self.sums.slope.add(weighted, 1.0);
        }
    }

    fn infer_segment<S: Scalar>(&mut self, numbers: &Numbers, passed: &mut PassedCell<'_, S>) {
        let (at, segment) = (passed.segment_number, &mut *passed.segment);
        let [bias, kink] = [Noise::Bias, Noise::Kink].map(|noise| &passed.found.of[noise as usize]);
        let opened = numbers.start_shock_percent * numbers.start_shock_percent;
        let bend = ClosedStep::new(at, kink);
        if segment.bias_shock < opened {
            let step = ClosedStep::new(at, bias);
            if step.exceeds(&bend, numbers) {
                self.bias_step = self.bias_step.larger(step);
            }
            let most = numbers.bias_shock_most_percent;
            self.add_odds(&step, bias.information.to_f32(), most);
        }
        if segment.kink < opened {
            self.kink = self.kink.larger(bend);
        }
        let most = numbers.bias_shock_most_percent;
        let (shape, scale) = (numbers.shock_shape, numbers.bias_shock_percent);
        segment.bias_shock =
            Scalar::min(most * most, shock(shape, scale, segment.bias_shock, bias));
        let (shape, scale) = (numbers.shock_shape, numbers.kink_percent);
        let most = numbers.kink_most_percent;
        segment.kink = Scalar::min(most * most, shock(shape, scale, segment.kink, kink));
        let road = core::mem::take(&mut self.road);
        let slow_gnss = core::mem::take(&mut self.slow_gnss);
        let multiplier = |sum: LevelSum, freedom: f32, most: f32| {
            let assumed = 0.5 * freedom;
            let determined = assumed - numbers.uninformed + 0.5 * sum.determined;
            Scalar::min(most, (assumed + 0.5 * sum.squares) / determined)
        };
        segment.road = multiplier(road, numbers.freedom, numbers.road_most);
        segment.slow_gnss =
            multiplier(slow_gnss, numbers.slow_gnss_freedom, numbers.slow_gnss_most);
    }

    /// Adds the odds of a closed step: its likelihood with the largest sigma over that without it.
    pub(super) fn add_odds(&mut self, step: &ClosedStep, information: f32, most: f32) {
        let ratio = most * most * information;
        let log = 0.5 * step.evidence * ratio / (1.0 + ratio);
        let odds = libm::expf(Scalar::min(log, 40.0)) / Scalar::sqrt(1.0 + ratio);
        self.odds += odds;
        self.likeliest = self.likeliest.larger(ClosedStep {
            evidence: odds,
            ..*step
        });
    }

    /// Opens the closed steps with the most evidence, one of the bias and one of the road. A variance
    /// that has shrunk hardly grows again by itself.
    pub fn revive(&self, numbers: &Numbers, segments: &mut [SegmentVariances]) {
        let opened = |step: &ClosedStep, most: f32| {
            let size = Scalar::min(step.size_percent.abs(), most);
            size * size
        };
        if self.bias_step.evidence > numbers.gate
            && let Some(segment) = segments.get_mut(self.bias_step.segment)
        {
            let shock = opened(&self.bias_step, numbers.bias_shock_most_percent);
            segment.bias_shock = Scalar::max(segment.bias_shock, shock);
        }
        if self.kink.evidence > numbers.gate
            && let Some(segment) = segments.get_mut(self.kink.segment)
        {
            let kink = opened(&self.kink, numbers.kink_most_percent);
            segment.kink = Scalar::max(segment.kink, kink);
        }
    }

    /// Returns the variance that a step adds behind its segment which is neither certain nor excluded,
    /// %²: p (1 − p) times its square.
    #[must_use]
    pub fn undecided_variance(&self, numbers: &Numbers) -> f32 {
        let odds = numbers.step_odds * self.odds;
        let probability = odds / (1.0 + odds);
        let size = Scalar::min(self.likeliest.size_percent.abs(), 1.0);
        probability * (1.0 - probability) * size * size
    }
}

impl ClosedStep {
    pub(super) fn new<S: Scalar>(segment: usize, score: &Score<S>) -> Self {
        let (sum, information) = (score.sum.to_f32(), score.information.to_f32());
        if information <= 0.0 {
            return Self::default();
        }
        Self {
            segment,
            evidence: sum * sum / information,
            size_percent: sum / information,
        }
    }

    /// Returns whether a step of the bias is clearly likelier than a kink of the road in its place.
    /// Altitudes distinguish the two. Speeds do not.
    pub(super) fn exceeds(&self, kink: &Self, numbers: &Numbers) -> bool {
        self.evidence > kink.evidence + numbers.step_margin
    }

    fn larger(self, other: Self) -> Self {
        if other.evidence > self.evidence {
            other
        } else {
            self
        }
    }
}

/// Returns the expected square of the error of a measurement of this variance.
fn expected_square<S: Scalar>(variance: S, score: &Score<S>) -> f32 {
    let unknown = (variance - variance.squared() * score.information).max(S::ZERO);
    ((variance * score.sum).squared() + unknown).to_f32()
}

/// Returns the next variance of a shock.
fn shock<S: Scalar>(shape: f32, scale: f32, variance: f32, score: &Score<S>) -> f32 {
    let sum = variance * score.sum.to_f32();
    let determined = variance * Scalar::max(score.information.to_f32(), 0.0);
    let next = (shape * scale * scale + 0.5 * sum * sum) / (shape + 0.5 + 0.5 * determined);
    if variance <= 0.0 {
        return next;
    }
    // Half a step further in the logarithm: a window has few rounds, and shocks go to their fixed point
    // from one side.
    next * Scalar::sqrt(Scalar::min(next / variance, LARGEST_GROWTH))
}

/// Returns the next variance of a load change. It moves from the last one only as far as the data
/// determine it: the load is unknown until a hill shows it. A reported mass is believed at once.
fn load_change<S: Scalar>(
    numbers: &Numbers,
    cell: &CellInput,
    variance: f32,
    score: &Score<S>,
) -> f32 {
    let next = shock(numbers.shock_shape, numbers.load_shock, variance, score);
    if cell.marks.load_told {
        return next;
    }
    let determined = variance * Scalar::max(score.information.to_f32(), 0.0);
    variance + determined / (1.0 + determined) * (next - variance)
}
