//! Low-passes of a signal at a row of time constants, and how well another one follows each.
//!
//! Means and variances forget. All are of readings that come about every two seconds.

use crate::mean_and_variance::MeanAndVariance;
use crate::scalar::{Scalar, ln};
use heapless::Vec;

/// Number of outputs: the signal itself, and its low-passes.
const OUTPUTS: usize = 13;
/// Outputs from one time constant to its double.
const A_DOUBLING: usize = 2;
/// Time constant of the first low-pass, s, and the ratio of each to the one before.
const FIRST_S: f32 = 1.0;
const RATIO: f32 = core::f32::consts::SQRT_2;
/// Logarithm of the ratio.
const LN_RATIO: f32 = 0.5 * core::f32::consts::LN_2;
/// Least bend of the misfit over its least value, so that no parabola is flat.
const LEAST_BEND: f32 = 0.1;

/// The signal behind one low-pass.
#[derive(Clone, Copy, Debug)]
struct Output {
    value: f32,
    low_pass: Passed,
    /// Behind the all-pass of the same delay.
    all_pass: Passed,
}

/// A passed signal beside the follower.
#[derive(Clone, Copy, Debug)]
struct Passed {
    moments: MeanAndVariance,
    /// Covariance with the follower.
    covariance: f32,
}

/// The low-passes.
#[derive(Clone, Debug)]
pub(super) struct LowPassBank {
    /// The first one is the signal itself. Of a length that compilers do not know, so that they do
    /// not unroll loops.
    outputs: Vec<Output, OUTPUTS>,
    /// Lowest and highest output.
    range: (f32, f32),
    follower: MeanAndVariance,
    readings: u16,
}

/// The low-pass that the follower fits best.
#[derive(Clone, Copy, Debug)]
pub(super) struct BestLowPass {
    /// The output nearest to it.
    pub output: u8,
    pub time_constant_s: f32,
    pub sigma_s: f32,
    /// Evidence against the other output that was asked for.
    pub evidence: f32,
}

impl LowPassBank {
    pub(super) fn new() -> Self {
        let output = Output {
            value: 0.0,
            low_pass: Passed::NONE,
            all_pass: Passed::NONE,
        };
        Self {
            outputs: Vec::from_array([output; OUTPUTS]),
            range: (0.0, 0.0),
            follower: MeanAndVariance::NONE,
            readings: 0,
        }
    }

    /// Returns the number of readings that count.
    pub(super) fn readings(&self, memory: u16) -> f32 {
        f32::from(self.readings.min(memory))
    }

    /// Returns the variance of the follower.
    pub(super) const fn follower_variance(&self) -> f32 {
        self.follower.variance
    }

    /// Lets all readings so far count as so many at most.
    pub(super) fn forget(&mut self, most: u16) {
        self.readings = self.readings.min(most);
    }

    /// Starts all low-passes from nought. What was compared stays.
    pub(super) fn settle(&mut self) {
        for output in &mut self.outputs {
            output.value = 0.0;
        }
        self.range = (0.0, 0.0);
    }

    /// Moves the low-passes over an interval, by the mean of the signal in it.
    pub(super) fn advance(&mut self, signal: f32, duration_s: f32) {
        let Some((itself, passes)) = self.outputs.split_first_mut() else {
            return;
        };
        let between = 0.5 * (itself.value + signal);
        itself.value = signal;
        let (mut lowest, mut highest) = (signal, signal);
        let mut time_constant_s = FIRST_S;
        for output in passes {
            output.value += low_pass_gain(time_constant_s, duration_s) * (between - output.value);
            lowest = Scalar::min(lowest, output.value);
            highest = Scalar::max(highest, output.value);
            time_constant_s *= RATIO;
        }
        self.range = (lowest, highest);
    }

    /// Returns an output.
    pub(super) fn output(&self, index: u8) -> f32 {
        let output = self.outputs.get(usize::from(index));
        output.map_or(0.0, |output| output.value)
    }

    /// Returns by how much a value is beyond the signal `now` and all outputs before it.
    pub(super) fn beyond(&self, value: f32, now: f32) -> f32 {
        let (lowest, highest) = self.range;
        let below = Scalar::min(lowest, now) - value;
        let above = value - Scalar::max(highest, now);
        Scalar::max(0.0, Scalar::max(below, above))
    }

    /// Compares the follower with all outputs. The bank remembers so many readings.
    pub(super) fn compare(&mut self, follower: f32, memory: u16) {
        self.readings = self.readings.saturating_add(1);
        let gain = 1.0 / Scalar::max(1.0, self.readings(memory));
        let of_follower = follower - self.follower.mean;
        self.follower.add(of_follower, gain);
        let signal = self.outputs.first().map_or(0.0, |itself| itself.value);
        let mut before = [signal; A_DOUBLING];
        for output in &mut self.outputs {
            let [half, next] = before;
            before = [next, output.value];
            output.low_pass.add(output.value, of_follower, gain);
            // An all-pass is twice the low-pass of half its time constant, less the signal.
            output.all_pass.add(2.0 * half - signal, of_follower, gain);
        }
    }

    /// Returns the evidence that the follower is late, by all-passes.
    pub(super) fn evidence_of_delay(&self, memory: u16) -> f32 {
        let itself = self.misfit_behind(0);
        let mut least = itself;
        for index in 1..self.outputs.len() {
            least = Scalar::min(least, self.misfit_behind(index));
        }
        self.evidence(itself, least, memory)
    }

    /// Returns the variance of the follower that an all-pass does not explain.
    #[inline(never)] // So that no compiler unrolls the loop.
    fn misfit_behind(&self, index: usize) -> f32 {
        let output = self.outputs.get(index);
        output.map_or(0.0, |output| output.all_pass.misfit(self.follower.variance))
    }

    /// Returns the low-pass that the follower fits best, and the evidence against another output.
    pub(super) fn best(&self, other: u8, memory: u16) -> BestLowPass {
        let (mut best, mut least) = (0, f32::INFINITY);
        for index in 0..self.outputs.len() {
            let misfit = self.misfit(index);
            if misfit < least {
                (best, least) = (index, misfit);
            }
        }
        let middle = best.clamp(2, OUTPUTS - 2);
        let [before, here, after] = [middle - 1, middle, middle + 1].map(|at| self.misfit(at));
        let bend = Scalar::max(before - 2.0 * here + after, LEAST_BEND * here);
        let step = Scalar::min(1.0, Scalar::max(-1.0, 0.5 * (before - after) / bend));
        let steps = LN_RATIO * step;
        let mut time_constant_s = FIRST_S * (1.0 + steps * (1.0 + 0.5 * steps));
        for _ in 1..middle {
            time_constant_s *= RATIO;
        }
        // Errors of the signal last as long as the low-pass.
        let independent = self.readings(memory) / time_constant_s;
        let sigma = LN_RATIO * Scalar::sqrt(2.0 * here / (independent * bend));
        BestLowPass {
            output: best as u8,
            time_constant_s,
            sigma_s: time_constant_s * Scalar::min(1.0, sigma),
            evidence: self.evidence(self.misfit(usize::from(other)), least, memory),
        }
    }

    /// Returns the variance of the follower that a low-pass does not explain.
    #[inline(never)]
    fn misfit(&self, index: usize) -> f32 {
        let output = self.outputs.get(index);
        output.map_or(f32::INFINITY, |output| {
            output.low_pass.misfit(self.follower.variance)
        })
    }

    /// Returns readings times the logarithm of the ratio of two variances; zero where the second one
    /// is not the smaller one.
    #[inline(never)]
    pub(super) fn evidence(&self, more: f32, less: f32, memory: u16) -> f32 {
        if more > less && less > 0.0 {
            self.readings(memory) * ln(more / less)
        } else {
            0.0
        }
    }
}

impl Passed {
    const NONE: Self = Self {
        moments: MeanAndVariance::NONE,
        covariance: 0.0,
    };

    #[inline(never)] // Called twice, in a loop.
    fn add(&mut self, value: f32, of_follower: f32, gain: f32) {
        let apart = value - self.moments.mean;
        self.covariance = (1.0 - gain) * (self.covariance + gain * of_follower * apart);
        self.moments.add(apart, gain);
    }

    /// Returns the variance of the follower that is not explained, whatever the gain: the signal may
    /// be off by a scale.
    #[inline(never)] // Called from two places.
    fn misfit(&self, of_follower: f32) -> f32 {
        let covariance = Scalar::max(0.0, self.covariance);
        let explained = covariance * covariance / self.moments.variance;
        // Not a number without a signal.
        Scalar::max(0.0, of_follower - Scalar::max(0.0, explained))
    }
}

/// Returns the part by which a low-pass follows the mean of its input over an interval: that of the
/// bilinear transform, at most all.
#[inline(never)]
pub(super) fn low_pass_gain(time_constant_s: f32, duration_s: f32) -> f32 {
    Scalar::min(1.0, 2.0 * duration_s / (2.0 * time_constant_s + duration_s))
}
