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

use super::gauss_markov::GaussMarkov;
use crate::scalar::Scalar;
use crate::tuning::{MeasurementNoise, ProcessNoise};

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
    /// Returns the level of the receiver's coloured error, given what its innovations alone say.
    pub(super) fn gnss_error_ratio(&self, of_innovations: f32) -> f32 {
        let (ratio, part) = self.receiver;
        of_innovations + part * (ratio - of_innovations)
    }
}

/// The levels, and the bank that finds them.
#[derive(Clone, Debug)]
pub(super) struct ErrorLevels {
    bank: [[Hypothesis; RECEIVER_LEVELS]; GROUPS.len()],
    open: OpenKnot,
    knot: Option<Knot>,
    /// Next hypothesis to take over the knot.
    next: u8,
    /// Best log-likelihood of the last round, and sums over the round under way.
    best: f32,
    sums: Sums,
    levels: Levels,
}

/// What a cell adds to a knot.
#[derive(Clone, Copy, Debug)]
pub(super) struct LevelCell {
    /// Length, m.
    pub length_m: f32,
    /// Duration, s.
    pub duration_s: f32,
    /// Climb by the forces, with the scale known so far, m.
    pub climb_m: f32,
    /// Variances of bias and wind as they are assumed, %².
    pub bias_variance: f32,
    pub wind_variance: f32,
}

/// A knot that is being filled.
#[derive(Clone, Copy, Debug, Default)]
struct OpenKnot {
    length_m: f32,
    duration_s: f32,
    climb_m: f32,
    /// Sums over fixes: altitude less the climb since the knot began, and variance.
    altitude_sum_m: f32,
    variance_sum: f32,
    fixes: f32,
}

/// A knot: the mean of its fixes, brought to its end by the climb of the forces.
#[derive(Clone, Copy, Debug)]
struct Knot {
    length_m: f32,
    duration_s: f32,
    climb_m: f32,
    altitude_m: f32,
    variance: f32,
    bias_variance: f32,
    wind_variance: f32,
}

/// A filter of altitude, bias, wind and receiver error, and its log-likelihood.
#[derive(Clone, Copy, Debug)]
struct Hypothesis {
    mean: [f32; STATES],
    covariance: [[f32; STATES]; STATES],
    /// Variance of the receiver's coloured error over the assumed one, 1.
    receiver_ratio: f32,
    log_likelihood: f32,
    is_started: bool,
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

const ALTITUDE: usize = 0;
const BIAS: usize = 1;
const WIND: usize = 2;
const RECEIVER: usize = 3;
/// Rate of a smooth error of the receiver.
const RATE: usize = 4;
const STATES: usize = 5;

/// One step of the receiver's coloured error.
#[derive(Clone, Copy, Debug)]
enum Receiver {
    /// Of first order.
    Coloured(GaussMarkov),
    /// Of second order, critically damped: transition, and variance in the long run.
    Smooth {
        transition: [[f32; 2]; 2],
        variances: [f32; 2],
    },
}

impl Receiver {
    /// Returns the step over a time in correlation times, and the variance of the rate.
    fn smooth(correlation_times: f32, time_s: f32, variance: f32) -> (Self, f32) {
        let (rate, keep) = (1.0 / time_s, libm::expf(-correlation_times));
        let transition = [
            [
                keep * (1.0 + correlation_times),
                keep * correlation_times * time_s,
            ],
            [
                -keep * correlation_times * rate,
                keep * (1.0 - correlation_times),
            ],
        ];
        let rate_variance = rate * rate * variance;
        let step = Self::Smooth {
            transition,
            variances: [variance, rate_variance],
        };
        (step, rate_variance)
    }

    fn predict(&self, x: &mut [f32; STATES], p: &mut [[f32; STATES]; STATES]) {
        let (transition, variances) = match self {
            Self::Coloured(markov) => {
                x[RECEIVER] *= markov.keep;
                keep(p, RECEIVER, markov);
                return;
            }
            Self::Smooth {
                transition,
                variances,
            } => (transition, variances),
        };
        let turn = |error: f32, rate: f32| {
            transition.map(|[of_error, of_rate]| of_error * error + of_rate * rate)
        };
        [x[RECEIVER], x[RATE]] = turn(x[RECEIVER], x[RATE]);
        let (error_row, rate_row) = (p[RECEIVER], p[RATE]);
        for (k, (error, rate)) in error_row.into_iter().zip(rate_row).enumerate() {
            [p[RECEIVER][k], p[RATE][k]] = turn(error, rate);
        }
        for row in p.iter_mut() {
            [row[RECEIVER], row[RATE]] = turn(row[RECEIVER], row[RATE]);
        }
        // What keeps the variances as they are in the long run: P - F P F'.
        let [error, rate] = *variances;
        let [[a, b], [c, d]] = *transition;
        p[RECEIVER][RECEIVER] += error - a * a * error - b * b * rate;
        p[RATE][RATE] += rate - c * c * error - d * d * rate;
        let joint = -(a * c * error + b * d * rate);
        p[RECEIVER][RATE] += joint;
        p[RATE][RECEIVER] += joint;
    }
}

/// Takes row and column of a state over a step of its process.
fn keep(p: &mut [[f32; STATES]; STATES], state: usize, markov: &GaussMarkov) {
    for element in &mut p[state] {
        *element *= markov.keep;
    }
    for row in p.iter_mut() {
        row[state] *= markov.keep;
    }
    p[state][state] += markov.variance;
}

impl Hypothesis {
    const NEW: Self = Self {
        mean: [0.0; STATES],
        covariance: [[0.0; STATES]; STATES],
        receiver_ratio: 1.0,
        log_likelihood: 0.0,
        is_started: false,
    };

    /// Starts the altitude at a knot; the slow states stay.
    fn start(&mut self, knot: &Knot, wind: f32, receiver: f32, rate: f32) {
        let p = &mut self.covariance;
        if self.mean == [0.0; STATES] {
            *p = [[0.0; STATES]; STATES];
            p[BIAS][BIAS] = knot.bias_variance;
            p[WIND][WIND] = wind;
            p[RECEIVER][RECEIVER] = receiver;
            p[RATE][RATE] = rate;
        }
        self.mean[ALTITUDE] = knot.altitude_m - self.mean[RECEIVER];
        let of_receiver = p[RECEIVER].map(|element| -element);
        p[ALTITUDE] = of_receiver;
        for (row, element) in p.iter_mut().zip(of_receiver) {
            row[ALTITUDE] = element;
        }
        p[ALTITUDE][ALTITUDE] = p[RECEIVER][RECEIVER] + knot.variance;
        self.is_started = true;
    }

    /// Takes the filter over a knot. Returns twice its negative log-likelihood.
    fn step(
        &mut self,
        knot: &Knot,
        bias: GaussMarkov,
        wind: GaussMarkov,
        receiver: Receiver,
    ) -> f32 {
        let (x, p) = (&mut self.mean, &mut self.covariance);
        let lever = -0.01 * knot.length_m;
        x[ALTITUDE] += knot.climb_m + lever * (x[BIAS] + x[WIND]);
        let (bias_row, wind_row) = (p[BIAS], p[WIND]);
        for (element, (bias, wind)) in p[ALTITUDE].iter_mut().zip(bias_row.iter().zip(wind_row)) {
            *element += lever * (bias + wind);
        }
        for row in p.iter_mut() {
            row[ALTITUDE] += lever * (row[BIAS] + row[WIND]);
        }
        let (x, p) = (&mut self.mean, &mut self.covariance);
        receiver.predict(x, p);
        for (i, markov) in [(BIAS, bias), (WIND, wind)] {
            x[i] *= markov.keep;
            keep(p, i, &markov);
        }
        // The new part of the wind acts on a half of the knot, as a mean.
        p[ALTITUDE][ALTITUDE] += lever * lever * wind.variance / 3.0;
        let mut cross = [0.0; STATES];
        for (k, cross) in cross.iter_mut().enumerate() {
            *cross = p[k][ALTITUDE] + p[k][RECEIVER];
        }
        let variance = cross[ALTITUDE] + cross[RECEIVER] + knot.variance;
        let innovation = knot.altitude_m - x[ALTITUDE] - x[RECEIVER];
        let per_variance = 1.0 / variance;
        for i in 0..STATES {
            let gain = cross[i] * per_variance;
            x[i] += gain * innovation;
            for k in 0..STATES {
                p[i][k] -= gain * cross[k];
            }
        }
        Scalar::min(innovation * innovation * per_variance, 25.0) + libm::logf(variance)
    }
}

impl ErrorLevels {
    /// Creates the bank, with the assumed levels in use.
    pub(super) const fn new() -> Self {
        Self {
            bank: [[
                Hypothesis {
                    receiver_ratio: 1.0 / RECEIVER_STEP,
                    ..Hypothesis::NEW
                },
                Hypothesis::NEW,
                Hypothesis {
                    receiver_ratio: RECEIVER_STEP,
                    ..Hypothesis::NEW
                },
            ]; GROUPS.len()],
            open: OpenKnot {
                length_m: 0.0,
                duration_s: 0.0,
                climb_m: 0.0,
                altitude_sum_m: 0.0,
                variance_sum: 0.0,
                fixes: 0.0,
            },
            knot: None,
            next: 0,
            best: 0.0,
            sums: Sums {
                best: f32::NEG_INFINITY,
                weight: 0.0,
                wind: 0.0,
                wind_length: 0.0,
                receiver_time: 0.0,
                receiver: 0.0,
                larger: 0.0,
            },
            levels: Levels {
                wind_ratio: 1.0,
                wind_length_ratio: 1.0,
                receiver_time_ratio: 1.0,
                receiver: (1.0, 0.0),
            },
        }
    }

    /// Returns the bank before its start, with the likelihoods and levels found so far.
    pub(super) fn restarted(&self) -> Self {
        let mut restarted = Self::new();
        for (new, old) in restarted
            .bank
            .iter_mut()
            .flatten()
            .zip(self.bank.iter().flatten())
        {
            new.log_likelihood = old.log_likelihood;
            new.receiver_ratio = old.receiver_ratio;
        }
        restarted.best = self.best;
        restarted.levels = self.levels;
        restarted
    }

    /// Returns the levels in use.
    pub(super) const fn levels(&self) -> Levels {
        self.levels
    }

    /// Notes that altitudes after here do not follow from those before.
    pub(super) fn interrupt(&mut self) {
        self.open = OpenKnot::default();
        self.knot = None;
        self.next = 0;
        self.sums = Sums {
            best: f32::NEG_INFINITY,
            ..Sums::default()
        };
        for hypothesis in self.bank.iter_mut().flatten() {
            hypothesis.is_started = false;
        }
    }

    /// Takes a fix at the end of the newest cell, above any fixed altitude, m.
    pub(super) fn fix(&mut self, altitude_m: f32, variance: f32) {
        self.open.altitude_sum_m += altitude_m - self.open.climb_m;
        self.open.variance_sum += variance;
        self.open.fixes += 1.0;
    }

    /// Advances over a cell.
    pub(super) fn advance(
        &mut self,
        cell: &LevelCell,
        process: &ProcessNoise,
        measurement: &MeasurementNoise,
    ) {
        let open = &mut self.open;
        if open.length_m >= process.level_knot_m && open.fixes > 0.0 && self.knot.is_none() {
            self.knot = Some(Knot {
                length_m: open.length_m,
                duration_s: open.duration_s,
                climb_m: open.climb_m,
                altitude_m: open.altitude_sum_m / open.fixes + open.climb_m,
                variance: open.variance_sum / (open.fixes * open.fixes),
                bias_variance: cell.bias_variance,
                wind_variance: cell.wind_variance,
            });
            *open = OpenKnot::default();
        }
        open.length_m += cell.length_m;
        open.duration_s += cell.duration_s;
        open.climb_m += cell.climb_m;
        if let Some(knot) = self.knot {
            self.take(&knot, process, measurement);
        }
    }

    fn take(&mut self, knot: &Knot, process: &ProcessNoise, measurement: &MeasurementNoise) {
        let index = usize::from(self.next);
        let level = index / RECEIVER_LEVELS % GROUPS.len();
        let Group {
            wind: wind_ratio,
            wind_length: wind_length_ratio,
            receiver_time,
            is_smooth,
        } = GROUPS[level];
        let Some(group) = self.bank.get_mut(level) else {
            return;
        };
        let hypothesis = &mut group[index % RECEIVER_LEVELS];
        let receiver_sigma_m = measurement.gnss_error_sigma_m;
        let receiver_variance = hypothesis.receiver_ratio * receiver_sigma_m * receiver_sigma_m;
        let wind_variance = wind_ratio * knot.wind_variance;
        let time_s = receiver_time * measurement.gnss_error_time_s;
        let (receiver, rate_variance) = if is_smooth {
            Receiver::smooth(knot.duration_s / time_s, time_s, receiver_variance)
        } else {
            let markov = GaussMarkov::step(knot.duration_s / time_s, receiver_variance);
            (Receiver::Coloured(markov), 0.0)
        };
        if hypothesis.is_started {
            let wind_length_m = wind_length_ratio * process.wind_length_m;
            let lost = hypothesis.step(
                knot,
                GaussMarkov::step(knot.length_m / process.bias_length_m, knot.bias_variance),
                GaussMarkov::step(knot.length_m / wind_length_m, wind_variance),
                receiver,
            );
            hypothesis.log_likelihood *= 1.0 - knot.length_m / process.level_memory_m;
            hypothesis.log_likelihood -= 0.5 * lost;
        } else {
            hypothesis.start(knot, wind_variance, receiver_variance, rate_variance);
        }
        if index % RECEIVER_LEVELS == RECEIVER_LEVELS - 1 {
            let (best, receiver_ratio) = settle(group, measurement);
            // A level as assumed needs no evidence.
            let credit = if wind_ratio > 1.0 {
                process.level_evidence
            } else {
                0.0
            };
            let likelihood = best - credit;
            self.sums.best = Scalar::max(self.sums.best, likelihood);
            let weight = libm::expf(Scalar::min(likelihood - self.best, 20.0));
            self.sums.weight += weight;
            self.sums.wind += weight * wind_ratio;
            self.sums.wind_length += weight * wind_length_ratio;
            self.sums.receiver_time += weight * if is_smooth { 1.0 } else { receiver_time };
            self.sums.receiver += weight * receiver_ratio;
            if level > 0 && !is_smooth {
                self.sums.larger += weight;
            }
        }
        self.next += 1;
        if usize::from(self.next) < HYPOTHESES {
            return;
        }
        self.next = 0;
        self.knot = None;
        let sums = core::mem::take(&mut self.sums);
        self.sums.best = f32::NEG_INFINITY;
        self.best = sums.best;
        if sums.weight > 0.0 {
            let per_weight = 1.0 / sums.weight;
            self.levels = Levels {
                wind_ratio: sums.wind * per_weight,
                wind_length_ratio: sums.wind_length * per_weight,
                receiver_time_ratio: sums.receiver_time * per_weight,
                receiver: (sums.receiver * per_weight, sums.larger * per_weight),
            };
        }
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
    (
        best + 0.5 * at * (down - up) - 0.5 * at * at * bend,
        ratio
            * (1.0
                + at * (if at > 0.0 {
                    RECEIVER_STEP - 1.0
                } else {
                    1.0 - 1.0 / RECEIVER_STEP
                })),
    )
}
