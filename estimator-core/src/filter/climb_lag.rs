//! How late the climb by the force is beside the climb by altitudes.
//!
//! A force that is late by τ climbs `c(t − τ)` where the altitudes climb `c(t)`. The difference of
//! both is τ times the rate of change of the climb by the force. Its own errors do not show as a lag:
//! noise is uncorrelated with its rate of change, and so is a slope that is wrong by a factor. But a
//! wrong mass also leaves a part of the acceleration, and trucks lose speed where roads get steeper:
//! that part is a second regressor. The force is taken as it is measured. The slope of the filter is
//! late by itself where speed or force are noisy.

use super::low_pass_bank::low_pass_gain;

/// Least time between two altitudes that are compared, s, and largest one.
const APART_S: (f32, f32) = (1.9, 4.0);
/// Faster changes are noise of altitudes, and slower ones errors of the force, s.
const FAST_S: f32 = 6.0;
const SLOW_S: f32 = 60.0;
/// Largest difference of vertical speeds, m/s: beyond, one of them is an outlier.
const FASTEST_MPS: f32 = 1.5;
/// Readings until both low-passes have settled.
const SETTLED: u8 = 5;
/// Readings before the first decision, and from one to the next.
const FEWEST: u16 = 180;
const DECIDE_EVERY: u8 = 10;
/// Sigma of a lag over that of independent readings: those next to each other are alike.
const ALIKE: f32 = 1.5;
/// Sigmas from which on a lag is certain, and least lag that counts, s: more than what is left of one
/// that is corrected.
const CERTAIN_SIGMAS: f32 = 5.0;
const LEAST_S: f32 = 0.7;
/// Part of the acceleration that a wrong mass may leave, 1 sigma: what climbs have not shown of it.
const PART_SIGMA: f32 = 0.1;
/// Largest lag, s: older torque is hardly used, so beyond, the model is off by something else.
const MOST_S: f32 = 3.0;

/// A cell, for both climbs.
#[derive(Clone, Copy, Debug)]
pub(super) struct ClimbCell {
    /// Climb by the net traction, before the speed took its part, m.
    pub traction_climb_m: f32,
    pub duration_s: f32,
    /// Height that the kinetic energy at the end is worth, m.
    pub speed_height_m: f32,
}

/// What came since an altitude.
#[derive(Clone, Copy, Debug)]
struct Since {
    altitude_m: f32,
    speed_height_m: f32,
    traction_climb_m: f32,
    duration_s: f32,
}

/// The climbs behind the low-passes, m/s.
#[derive(Clone, Copy, Debug, Default)]
struct Climbs {
    force_mps: f32,
    altitudes_mps: f32,
    /// What the speed gains, as the height that its energy is worth.
    gained_mps: f32,
}

/// Means of squares and products: of the rate of the climb, of what the speed gains, and of the
/// difference of the climbs.
#[derive(Clone, Copy, Debug, Default)]
struct Means {
    rates: f32,
    gains: f32,
    differences: f32,
    rate_gain: f32,
    rate_difference: f32,
    gain_difference: f32,
}

/// The comparison.
#[derive(Clone, Debug, Default)]
pub(super) struct ClimbLag {
    since: Option<Since>,
    speed_height_m: f32,
    fast: Climbs,
    slow: Climbs,
    settled: u8,
    /// The last two readings, the newest first, and the time between them, s.
    last: Climbs,
    last_but_one: Climbs,
    last_s: f32,
    means: Means,
    readings: u16,
    until_decision: u8,
    late_s: f32,
}

impl Climbs {
    fn follow(&mut self, other: Self, gain: f32) {
        self.force_mps += gain * (other.force_mps - self.force_mps);
        self.altitudes_mps += gain * (other.altitudes_mps - self.altitudes_mps);
        self.gained_mps += gain * (other.gained_mps - self.gained_mps);
    }

    fn less(self, other: Self) -> Self {
        Self {
            force_mps: self.force_mps - other.force_mps,
            altitudes_mps: self.altitudes_mps - other.altitudes_mps,
            gained_mps: self.gained_mps - other.gained_mps,
        }
    }
}

impl ClimbLag {
    /// Returns the comparison before its start, with the lag found so far.
    pub(super) fn restarted(&self) -> Self {
        Self {
            late_s: self.late_s,
            ..Self::default()
        }
    }

    /// Returns by how much the force is late, s; zero unless that is certain.
    pub(super) const fn late_s(&self) -> f32 {
        self.late_s
    }

    /// Notes that what comes does not follow from what was before.
    pub(super) fn interrupt(&mut self) {
        self.since = None;
        self.settled = 0;
    }

    /// Advances over a cell over which the model holds.
    #[inline]
    pub(super) fn advance(&mut self, cell: &ClimbCell) {
        self.speed_height_m = cell.speed_height_m;
        if let Some(since) = &mut self.since {
            since.traction_climb_m += cell.traction_climb_m;
            since.duration_s += cell.duration_s;
        }
    }

    /// Takes an altitude at the end of the last cell, m. The comparison remembers so many readings.
    #[inline(never)] // Not in every cell.
    pub(super) fn fix(&mut self, altitude_m: f32, memory: u16) {
        let speed_height_m = self.speed_height_m;
        let now = Since {
            altitude_m,
            speed_height_m,
            traction_climb_m: 0.0,
            duration_s: 0.0,
        };
        let (least_s, most_s) = APART_S;
        let Some(since) = self.since else {
            self.since = Some(now);
            return;
        };
        if since.duration_s < least_s {
            return;
        }
        self.since = Some(now);
        let gained_m = speed_height_m - since.speed_height_m;
        let climbs = Climbs {
            force_mps: (since.traction_climb_m - gained_m) / since.duration_s,
            altitudes_mps: (altitude_m - since.altitude_m) / since.duration_s,
            gained_mps: gained_m / since.duration_s,
        };
        let apart_mps = climbs.altitudes_mps - climbs.force_mps;
        let is_outlier =
            (apart_mps - (self.slow.altitudes_mps - self.slow.force_mps)).abs() > FASTEST_MPS;
        if since.duration_s > most_s || (is_outlier && self.settled > 0) {
            self.interrupt();
            return;
        }
        self.pass(climbs, since.duration_s, memory);
    }

    /// Passes both climbs through the low-passes, and compares what comes out.
    fn pass(&mut self, climbs: Climbs, duration_s: f32, memory: u16) {
        if self.settled == 0 {
            (self.fast, self.slow) = (climbs, climbs);
        }
        self.fast.follow(climbs, low_pass_gain(FAST_S, duration_s));
        self.slow
            .follow(self.fast, low_pass_gain(SLOW_S, duration_s));
        let now = self.fast.less(self.slow);
        let (middle, first) = (self.last, self.last_but_one);
        let span_s = duration_s + self.last_s;
        (self.last, self.last_but_one, self.last_s) = (now, middle, duration_s);
        if self.settled < SETTLED {
            self.settled += 1;
            return;
        }
        let rate = (now.force_mps - first.force_mps) / span_s;
        self.compare(rate, &middle, memory);
    }

    fn compare(&mut self, rate: f32, middle: &Climbs, memory: u16) {
        self.readings = self.readings.saturating_add(1);
        let gain = 1.0 / f32::from(self.readings.min(memory));
        let gained = middle.gained_mps;
        self.means
            .add(rate, gained, middle.altitudes_mps - middle.force_mps, gain);
        self.until_decision = self.until_decision.saturating_sub(1);
        if self.until_decision == 0 {
            self.until_decision = DECIDE_EVERY;
            self.decide(memory);
        }
    }

    #[inline(never)] // Rare.
    fn decide(&mut self, memory: u16) {
        if self.readings < FEWEST {
            return;
        }
        let (lag_s, variance) = self.means.lag(f32::from(self.readings.min(memory)));
        let variance = ALIKE * ALIKE * variance;
        let is_certain = lag_s * lag_s > CERTAIN_SIGMAS * CERTAIN_SIGMAS * variance;
        if !is_certain || lag_s.abs() < LEAST_S {
            return;
        }
        let late_s = self.late_s + lag_s;
        if late_s > MOST_S {
            return;
        }
        self.late_s = if late_s < LEAST_S { 0.0 } else { late_s };
        self.readings = 0;
    }
}

impl Means {
    fn add(&mut self, rate: f32, gained: f32, difference: f32, gain: f32) {
        let follow = |mean: &mut f32, product: f32| *mean += gain * (product - *mean);
        follow(&mut self.rates, rate * rate);
        follow(&mut self.gains, gained * gained);
        follow(&mut self.differences, difference * difference);
        follow(&mut self.rate_gain, rate * gained);
        follow(&mut self.rate_difference, rate * difference);
        follow(&mut self.gain_difference, gained * difference);
    }

    /// Returns the lag, s, and its variance if readings are independent: the regression of the
    /// difference on the rate and on what the speed gains. Not a number where nothing changes.
    fn lag(&self, readings: f32) -> (f32, f32) {
        let gains = self.gains + self.differences / (readings * PART_SIGMA * PART_SIGMA);
        let determinant = self.rates * gains - self.rate_gain * self.rate_gain;
        let of_rate = gains * self.rate_difference - self.rate_gain * self.gain_difference;
        let of_gain = self.rates * self.gain_difference - self.rate_gain * self.rate_difference;
        let (lag_s, part) = (of_rate / determinant, of_gain / determinant);
        let left = self.differences - lag_s * self.rate_difference - part * self.gain_difference;
        (lag_s, left * gains / (determinant * readings))
    }
}
