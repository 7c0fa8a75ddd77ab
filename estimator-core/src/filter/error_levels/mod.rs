//! Levels of the two coloured errors, from competing hypotheses.
//!
//! The climb by GNSS and the climb by the forces differ for two reasons: the coloured error of the
//! receiver, and the slow error of the vehicle model (wind, torque, surface). The filter trusts one
//! as much as it distrusts the other, so a wrong level of either makes its sigma wrong. How large
//! each is, single innovations do not show. The differences over hundreds of metres and kilometres
//! do: the receiver's error stays within bounds, that of the model adds up to a climb.
//!
//! A bank of small filters follows the difference, each with other levels. The likelihood of their
//! innovations weighs them (D. T. Magill, "Optimal adaptive estimation of sampled stochastic
//! processes", IEEE Trans. Automatic Control 10:434, 1965). It forgets over kilometres, since wind
//! and surface change. A knot joins the cells of some eighty metres, and each cell takes one
//! hypothesis over the last knot, so that no step takes much longer than another.

mod hypothesis;
mod knot;

use super::gauss_markov::GaussMarkov;
use crate::scalar::Scalar;
use crate::tuning::{MeasurementNoise, ProcessNoise};
use heapless::Vec;
use hypothesis::{Hypothesis, Receiver, SmoothError};
use knot::{Knot, OpenKnot};
pub(super) use knot::{LevelCell, SlowVariances};

/// Ratios of a group of hypotheses to what is assumed.
#[derive(Clone, Copy)]
struct Group {
    /// Variance and correlation length of the model's slow error.
    wind: f32,
    wind_length: f32,
    /// Correlation time of the receiver's coloured error: receivers that smooth or lag have errors
    /// that follow the road.
    receiver_time: f32,
    /// Whether that error is smooth: of second order, critically damped.
    is_smooth: bool,
}

const fn group(wind: f32, wind_length: f32, receiver_time: f32) -> Group {
    Group {
        wind,
        wind_length,
        receiver_time,
        is_smooth: false,
    }
}

/// A receiver with a smooth error.
const fn smooth(wind: f32, wind_length: f32, receiver_time: f32) -> Group {
    Group {
        is_smooth: true,
        ..group(wind, wind_length, receiver_time)
    }
}

/// As assumed, or larger and faster.
const GROUPS: [Group; 14] = [
    group(1.0, 1.0, 1.0),
    smooth(1.0, 1.0, 0.05),
    smooth(1.0, 1.0, 0.15),
    group(1.0, 1.0, 0.15),
    group(4.0, 1.0, 1.0),
    smooth(4.0, 1.0, 0.05),
    smooth(4.0, 1.0, 0.15),
    group(4.0, 0.2, 1.0),
    group(16.0, 0.2, 1.0),
    smooth(16.0, 0.2, 0.05),
    smooth(16.0, 0.2, 0.15),
    group(64.0, 0.2, 1.0),
    group(256.0, 0.2, 1.0),
    group(1_024.0, 0.2, 1.0),
];
/// Levels of the receiver's error beside each: a smaller one, the best so far, and a larger one.
const RECEIVER_LEVELS: usize = 3;
const HYPOTHESES: usize = GROUPS.len() * RECEIVER_LEVELS;
/// Step from one of them to the next, as a variance ratio.
const RECEIVER_STEP: f32 = 1.5;

/// The levels in use.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Levels {
    /// Variance of the wind state over the assumed one, 1.
    pub wind_ratio: f32,
    /// Its correlation length over the assumed one, 1.
    pub wind_length_ratio: f32,
    /// Correlation time of the receiver's coloured error over the assumed one, 1.
    pub receiver_time_ratio: f32,
    /// Variance of the receiver's coloured error over the assumed one, 1, and the part with which
    /// it counts.
    pub receiver: (f32, f32),
}

impl Levels {
    /// As assumed.
    pub(super) const ASSUMED: Self = Self {
        wind_ratio: 1.0,
        wind_length_ratio: 1.0,
        receiver_time_ratio: 1.0,
        receiver: (1.0, 0.0),
    };

    /// Returns the level of the receiver's coloured error, given what its innovations alone say.
    pub(super) fn gnss_error_ratio(&self, of_innovations: f32) -> f32 {
        let (ratio, part) = self.receiver;
        of_innovations + part * (ratio - of_innovations)
    }
}

/// The levels, and the bank that finds them.
#[derive(Clone, Debug)]
pub(super) struct ErrorLevels {
    /// The groups of [`GROUPS`] up to the newest that has taken a knot.
    bank: Vec<[Hypothesis; RECEIVER_LEVELS], { GROUPS.len() }>,
    open: OpenKnot,
    knot: Option<Knot>,
    /// Next hypothesis to take over the knot.
    next: u8,
    /// Number of hypotheses that have started since the last interruption: the first ones.
    started: u8,
    /// Best log-likelihood of the last round, and sums over the round under way.
    best: f32,
    sums: Sums,
    levels: Levels,
}

/// Sums over the hypotheses of a round, weighted by likelihood.
#[derive(Clone, Copy, Debug, Default)]
struct Sums {
    best: f32,
    weight: f32,
    wind: f32,
    wind_length: f32,
    receiver_time: f32,
    receiver: f32,
    larger: f32,
}

impl ErrorLevels {
    /// Creates the bank, with the assumed levels in use.
    #[inline(always)] // See Estimator::new_in().
    pub(super) fn new() -> Self {
        Self {
            bank: Vec::new(),
            open: OpenKnot::default(),
            knot: None,
            next: 0,
            started: 0,
            best: 0.0,
            sums: Sums::default(),
            levels: Levels::ASSUMED,
        }
    }

    /// Returns the bank before its start, with the likelihoods and levels found so far.
    pub(super) fn restarted(&self) -> Self {
        let mut restarted = self.clone();
        restarted.interrupt();
        for hypothesis in restarted.bank.iter_mut().flatten() {
            *hypothesis = hypothesis.restarted();
        }
        restarted
    }

    /// Returns the levels in use.
    pub(super) const fn levels(&self) -> Levels {
        self.levels
    }

    /// Notes that altitudes after here do not follow from those before.
    #[inline(never)] // Rare, and called from two places.
    pub(super) fn interrupt(&mut self) {
        self.open = OpenKnot::default();
        self.knot = None;
        self.next = 0;
        self.started = 0;
        self.sums = Sums::default();
    }

    /// Takes a fix at the end of the newest cell, above any fixed altitude, m.
    pub(super) fn fix(&mut self, altitude_m: f32, variance: f32) {
        self.open.fix(altitude_m, variance);
    }

    /// Returns whether the open knot is full, and the hypotheses are done with the one before.
    pub(super) fn knot_is_full(&self, process: &ProcessNoise) -> bool {
        self.knot.is_none() && self.open.is_full(process.level_knot_m)
    }

    /// Closes the open knot before the next cell, whose variances these are.
    pub(super) fn close_knot(&mut self, variances: &SlowVariances) {
        self.knot = Some(self.open.close(variances));
    }

    /// Advances over a cell.
    pub(super) fn advance(
        &mut self,
        cell: &LevelCell,
        process: &ProcessNoise,
        measurement: &MeasurementNoise,
    ) {
        self.open.advance(cell);
        if let Some(knot) = self.knot {
            self.take(&knot, process, measurement);
        }
    }

    /// Takes one hypothesis over a knot, and weighs its group once all of it is there.
    fn take(&mut self, knot: &Knot, process: &ProcessNoise, measurement: &MeasurementNoise) {
        let index = usize::from(self.next);
        let (number, which) = (index / RECEIVER_LEVELS, index % RECEIVER_LEVELS);
        if number == self.bank.len() {
            // There is room for all groups.
            let _ = self.bank.push([Hypothesis::EMPTY; RECEIVER_LEVELS]);
        }
        let (Some(members), Some(group)) = (self.bank.get_mut(number), GROUPS.get(number)) else {
            return;
        };
        let is_started = self.next < self.started;
        if !is_started {
            self.started = self.next + 1;
        }
        group.step(
            &mut members[which],
            which,
            is_started,
            knot,
            process,
            measurement,
        );
        if which == RECEIVER_LEVELS - 1 {
            let (likelihood, receiver_ratio) = settle(members, measurement);
            // A level as assumed needs no evidence.
            let evidence = if group.wind > 1.0 {
                process.level_evidence
            } else {
                0.0
            };
            let is_first = number == 0;
            self.sums.add(
                group,
                is_first,
                likelihood - evidence,
                self.best,
                receiver_ratio,
            );
        }
        self.next += 1;
        if usize::from(self.next) == HYPOTHESES {
            self.next = 0;
            self.knot = None;
            let sums = core::mem::take(&mut self.sums);
            self.best = sums.best;
            if let Some(levels) = sums.levels() {
                self.levels = levels;
            }
        }
    }
}

impl Group {
    /// Takes a hypothesis of this group over a knot.
    fn step(
        &self,
        hypothesis: &mut Hypothesis,
        which: usize,
        is_started: bool,
        knot: &Knot,
        process: &ProcessNoise,
        measurement: &MeasurementNoise,
    ) {
        if hypothesis.receiver_ratio == 0.0 {
            hypothesis.receiver_ratio = match which {
                0 => 1.0 / RECEIVER_STEP,
                1 => 1.0,
                _ => RECEIVER_STEP,
            };
        }
        let sigma_m = measurement.gnss_error_sigma_m;
        let receiver_variance = hypothesis.receiver_ratio * sigma_m * sigma_m;
        let time_s = self.receiver_time * measurement.gnss_error_time_s;
        let times = knot.duration_s / time_s;
        let receiver = if self.is_smooth {
            Receiver::Smooth(SmoothError::step(times, time_s, receiver_variance))
        } else {
            Receiver::Coloured(GaussMarkov::step(times, receiver_variance))
        };
        let wind_variance = self.wind * knot.wind_variance;
        if !is_started {
            hypothesis.start(knot, wind_variance, receiver_variance, &receiver);
            return;
        }
        let wind_length_m = self.wind_length * process.wind_length_m;
        let lost = hypothesis.step(
            knot,
            &GaussMarkov::step(knot.length_m / process.bias_length_m, knot.bias_variance),
            &GaussMarkov::step(knot.length_m / wind_length_m, wind_variance),
            &receiver,
        );
        hypothesis.log_likelihood *= 1.0 - knot.length_m / process.level_memory_m;
        hypothesis.log_likelihood -= 0.5 * lost;
    }
}

impl Sums {
    /// Adds a group with its log-likelihood. `best` is that of the last round.
    fn add(
        &mut self,
        group: &Group,
        is_first: bool,
        likelihood: f32,
        best: f32,
        receiver_ratio: f32,
    ) {
        if is_first || likelihood > self.best {
            self.best = likelihood;
        }
        let weight = libm::expf(Scalar::min(likelihood - best, 20.0));
        self.weight += weight;
        self.wind += weight * group.wind;
        self.wind_length += weight * group.wind_length;
        self.receiver += weight * receiver_ratio;
        if group.is_smooth {
            self.receiver_time += weight;
            return;
        }
        self.receiver_time += weight * group.receiver_time;
        if !is_first {
            self.larger += weight;
        }
    }

    /// Returns the weighted means.
    fn levels(&self) -> Option<Levels> {
        if self.weight <= 0.0 {
            return None;
        }
        let per_weight = 1.0 / self.weight;
        Some(Levels {
            wind_ratio: self.wind * per_weight,
            wind_length_ratio: self.wind_length * per_weight,
            receiver_time_ratio: self.receiver_time * per_weight,
            receiver: (self.receiver * per_weight, self.larger * per_weight),
        })
    }
}

/// Moves the receiver's levels of a group so that the best is in the middle. Returns the
/// log-likelihood and the ratio at the top of the parabola through the three.
fn settle(group: &mut [Hypothesis; RECEIVER_LEVELS], measurement: &MeasurementNoise) -> (f32, f32) {
    let [small, middle, large] = group;
    let (down, up) = (
        middle.log_likelihood - small.log_likelihood,
        middle.log_likelihood - large.log_likelihood,
    );
    let (best, ratio) = (middle.log_likelihood, middle.receiver_ratio);
    if down < -1.0 && small.receiver_ratio > measurement.gnss_error_ratio_low {
        *large = *middle;
        *middle = *small;
        small.receiver_ratio /= RECEIVER_STEP;
        return (middle.log_likelihood, middle.receiver_ratio);
    }
    if up < -1.0 && large.receiver_ratio < measurement.gnss_error_ratio_high {
        *small = *middle;
        *middle = *large;
        large.receiver_ratio *= RECEIVER_STEP;
        return (middle.log_likelihood, middle.receiver_ratio);
    }
    let bend = down + up;
    if bend <= 0.1 {
        return (best, ratio);
    }
    let at = Scalar::min(1.0, Scalar::max(-1.0, 0.5 * (down - up) / bend));
    let step = if at > 0.0 {
        RECEIVER_STEP - 1.0
    } else {
        1.0 - 1.0 / RECEIVER_STEP
    };
    let likelihood = best + 0.5 * at * (down - up) - 0.5 * at * at * bend;
    (likelihood, ratio * (1.0 + at * step))
}
