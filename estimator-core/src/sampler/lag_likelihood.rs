//! Which of a row of lags a signal has, by their likelihoods.
//!
//! At each lag there is a *target*, which is small or explained at the true one, and a *regressor*,
//! which may explain some of it. What linear regression leaves of the target is Gaussian noise whose
//! variance `R` is not known, so the logarithm of the likelihood of a lag is `−n/2 ln R`. Near its
//! least, `R` is a parabola: its place is the delay, its bend gives the sigma.

use super::speed_slots::SLOT_S;
use crate::delay::{BestFit, Delay};
use crate::scalar::{Scalar, ln};

/// Comparisons before the first decision: a minute.
const FEWEST: f32 = 60.0;
/// Comparisons over which means are taken off: what is slower shows no delay.
const MEAN_OF: f32 = 60.0;
/// Most that a target counts, m/s, or m/s²: beyond is an outlier.
const MOST: f32 = 1.0;
/// Largest correlation of one comparison with the next that is believed.
const MOST_ALIKE: f32 = 0.9;
/// Part of the variance at the worst lag that the best one has to explain, and can at most.
const CLEAR: f32 = 0.06;
const NEARLY_ALL: f32 = 0.9999;

/// The lags of a row, and how they are judged.
#[derive(Clone, Copy, Debug)]
pub(super) struct Row {
    /// First lag, s. From one to the next is a slot.
    pub first_s: f32,
    /// Distance from the assumed delay that does not matter, s.
    pub tolerance_s: f32,
    /// Whether target and regressor are changes: no means are taken off them, and a regressor explains
    /// only what has its own sign.
    pub is_of_changes: bool,
}

/// What is known of one lag.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Sums {
    /// Means of both.
    target: f32,
    regressor: f32,
    /// Sums of squares of both, and of products.
    targets: f32,
    regressors: f32,
    products: f32,
}

impl Sums {
    /// Returns what regression leaves of the sum of squares of the target. Of changes it is the part:
    /// not each one is compared at each lag.
    fn left(&self, row: &Row) -> f32 {
        let is_explained = !row.is_of_changes || self.products > 0.0;
        let left = if is_explained && self.regressors > 0.0 {
            self.targets - self.products * self.products / self.regressors
        } else {
            self.targets
        };
        if !row.is_of_changes {
            left
        } else if self.targets > 0.0 {
            left / self.targets
        } else {
            1.0
        }
    }
}

/// Whether one comparison is like the next, at the lag that holds.
#[derive(Clone, Copy, Debug, Default)]
struct Alike {
    lag: usize,
    /// The last target, sums of its squares and of products with the one before.
    before: f32,
    squares: f32,
    successive: f32,
}

/// The likelihoods of a row of lags. They forget.
#[derive(Clone, Debug)]
pub(super) struct LagLikelihood<Lags: ?Sized> {
    row: Row,
    /// What is known of the delay.
    pub delay: Delay,
    /// Number of comparisons, and the part of it that the newest one leaves.
    count: f32,
    keep: f32,
    /// Part of the newest comparison that counts in the means.
    gain: f32,
    alike: Alike,
    lags: Lags,
}

/// The lag that fits best.
struct Peak {
    lag_s: f32,
    sigma_s: f32,
    /// What it leaves, and the least that counts.
    left: f32,
    least: f32,
    /// Number of independent comparisons.
    count: f32,
    is_clear: bool,
}

impl<const COUNT: usize> LagLikelihood<[Sums; COUNT]> {
    #[inline(always)] // See Estimator::new_in().
    pub(super) fn new(row: Row) -> Self {
        Self {
            row,
            delay: Delay::Unestimated,
            count: 0.0,
            keep: 1.0,
            gain: 0.0,
            alike: Alike::default(),
            lags: [Sums::default(); COUNT],
        }
    }

    /// Returns it as all rows share their code.
    pub(super) const fn of_any_length(&mut self) -> &mut LagLikelihood<[Sums]> {
        self
    }
}

impl LagLikelihood<[Sums]> {
    /// Forgets all.
    pub(super) fn clear(&mut self) {
        self.delay = Delay::Unestimated;
        self.count = 0.0;
        self.alike = Alike::default();
        self.lags.fill(Sums::default());
    }

    /// Begins a comparison, of a memory of so many.
    pub(super) fn begin(&mut self, memory: f32) {
        self.keep = 1.0 - 1.0 / memory;
        self.count = self.keep * self.count + 1.0;
        if !self.row.is_of_changes {
            self.gain = 1.0 / Scalar::min(self.count, MEAN_OF);
        }
    }

    /// Adds target and regressor at a lag to the comparison that was begun.
    #[inline(never)] // Called from two places.
    pub(super) fn add(&mut self, lag: usize, target: f32, regressor: f32) {
        let keep = self.keep;
        let Some(sums) = self.lags.get_mut(lag) else {
            return;
        };
        sums.target += self.gain * (target - sums.target);
        sums.regressor += self.gain * (regressor - sums.regressor);
        let apart = bounded(target - sums.target, MOST);
        let regressor = regressor - sums.regressor;
        sums.targets = keep * sums.targets + apart * apart;
        sums.regressors = keep * sums.regressors + regressor * regressor;
        sums.products = keep * sums.products + apart * regressor;
        if lag == self.alike.lag {
            let alike = &mut self.alike;
            alike.squares = keep * alike.squares + apart * apart;
            alike.successive = keep * alike.successive + apart * alike.before;
            alike.before = apart;
        }
    }

    /// Decides on the delay. It is another one than assumed if the evidence, the logarithm of the
    /// ratio of their likelihoods, is `enough`.
    #[inline(never)] // Rare.
    pub(super) fn decide(&mut self, assumed_s: f32, enough: f32) {
        if self.count < FEWEST {
            return;
        }
        self.delay = self.judged(assumed_s, enough);
        let (lag, _) = self.nearest(self.delay.estimated_s().unwrap_or(assumed_s));
        if lag != self.alike.lag {
            self.alike = Alike {
                lag,
                ..Alike::default()
            };
        }
    }

    fn judged(&self, assumed_s: f32, enough: f32) -> Delay {
        let peak = self.peak();
        let apart_s = bounded(peak.lag_s - assumed_s, self.row.tolerance_s);
        let evidence = self.evidence(&peak, assumed_s + apart_s);
        let held_s = self.delay.estimated_s();
        let evidence_against = held_s.map_or(0.0, |held_s| self.evidence(&peak, held_s));
        let best = BestFit {
            delay_s: peak.lag_s,
            sigma_s: peak.sigma_s,
            is_clear: peak.is_clear,
        };
        self.delay.decided(best, evidence, evidence_against, enough)
    }

    /// Returns what regression leaves at a lag; infinity beyond the last.
    #[inline(never)] // Called from several places.
    fn left(&self, lag: usize) -> f32 {
        let sums = self.lags.get(lag);
        sums.map_or(f32::INFINITY, |sums| sums.left(&self.row))
    }

    /// Returns the lag in the middle of three that is nearest to a time, and how far that is behind
    /// it, in steps.
    fn nearest(&self, lag_s: f32) -> (usize, f32) {
        let place = (lag_s - self.row.first_s) / SLOT_S;
        let last = self.lags.len().saturating_sub(2);
        let lag = ((place + 0.5) as usize).min(last).max(1);
        (lag, place - lag as f32)
    }

    /// Returns the parabola through what is left at a lag and at its neighbours: half of its bend, its
    /// slope, and its value.
    fn parabola(&self, lag: usize) -> [f32; 3] {
        let (before, at, after) = (self.left(lag - 1), self.left(lag), self.left(lag + 1));
        [0.5 * (before + after) - at, 0.5 * (after - before), at]
    }

    /// Returns the evidence for the peak against another time.
    #[inline(never)] // Called from two places.
    fn evidence(&self, peak: &Peak, lag_s: f32) -> f32 {
        let (lag, aside) = self.nearest(lag_s);
        let [bend, slope, at] = self.parabola(lag);
        let left = Scalar::max(peak.least, at + aside * (slope + aside * bend));
        0.5 * peak.count * ln(left / peak.left)
    }

    /// Returns the number of independent comparisons: those that are alike count as fewer.
    fn independent(&self) -> f32 {
        let alike = self.alike.successive / self.alike.squares;
        if alike > 0.0 {
            let alike = Scalar::min(alike, MOST_ALIKE);
            self.count * (1.0 - alike) / (1.0 + alike)
        } else {
            self.count
        }
    }

    /// Returns the lag that fits best.
    fn peak(&self) -> Peak {
        let (mut best, mut left, mut most) = (0, f32::INFINITY, 0.0);
        for lag in 0..self.lags.len() {
            let at = self.left(lag);
            if at < left {
                (best, left) = (lag, at);
            }
            most = Scalar::max(most, at);
        }
        let least = Scalar::max((1.0 - NEARLY_ALL) * most, f32::MIN_POSITIVE);
        let count = self.independent();
        let (mut aside, mut sigma) = (0.0, f32::INFINITY);
        if best > 0 && best + 1 < self.lags.len() {
            let [bend, slope, _] = self.parabola(best);
            if bend > 0.0 {
                aside = -0.5 * slope / bend;
                // Where the bend is a kink, the parabola is too deep.
                left = Scalar::max(0.5 * left, left + 0.5 * aside * slope);
                sigma = Scalar::sqrt(Scalar::max(least, left) / (count * bend));
            }
        }
        Peak {
            lag_s: self.row.first_s + SLOT_S * (best as f32 + aside),
            sigma_s: SLOT_S * sigma,
            is_clear: sigma.is_finite() && left < (1.0 - CLEAR) * most,
            left: Scalar::max(least, left),
            least,
            count,
        }
    }
}

/// Returns a number, at most so large. Not `clamp`, which panics if the limits are in the wrong order.
pub(super) fn bounded(number: f32, most: f32) -> f32 {
    Scalar::min(most, Scalar::max(-most, number))
}
