//! A sensor that measures the slope directly: its noise, its offset, and its gain on the specific force.
//! They are learned where the model holds.

use super::super::body_sensor::{BodySensor, OffsetOrigin};
use super::super::noise_ratio::{NoiseRatio, learned_sigma, variance_ratio};
use crate::scalar::Scalar;
use crate::time::Instant;
use crate::tuning::MeasurementNoise;

/// Time over which the fast error of a reading keeps its value, s: the filter in a receiver, or the
/// natural frequency of a body on its springs.
const FAST_ERROR_S: f32 = 1.0;
/// Time over which readings are compared before they are used, s.
const LEARNING_S: f32 = 60.0;
/// Limits of learned over assumed variance, and the part of an innovation by which it follows.
const RATIO_LOW: f32 = 0.02;
const RATIO_HIGH: f32 = 100.0;
const RATIO_GAIN: f32 = 0.03;
/// Factor on the variance of what offset and gain are learned from: the errors of the estimate are
/// alike over many cells.
const COLOUR: f32 = 4.0;
/// Sigma to which the factor of a sensor has to be known before it is used: hills show it.
const FACTOR_SIGMA: f32 = 0.1;
/// Largest error of the factor beyond three sigmas. In another unit, or with another sign, it is larger.
const FACTOR_ERROR: f32 = 0.2;
/// Part of what is known of the factor that a reading leaves: a memory of a thousand readings.
const FACTOR_KEEP: f32 = 0.999;
/// Time over which equal readings are those of a stuck sensor, s.
const FROZEN_S: f32 = 30.0;

/// What is assumed of a sensor before its first reading, in % of slope.
pub(super) struct Assumed {
    pub offset_sigma_percent: f32,
    /// Change of the reading for each m/s² of specific force.
    pub gain: f32,
    pub gain_sigma: f32,
    /// They are never known better: they change with load and temperature.
    pub least_offset_sigma_percent: f32,
    pub least_gain_sigma: f32,
}

/// A reading, and what the filter knows of the same cell.
#[derive(Clone, Copy, Debug)]
pub(super) struct Reading {
    pub slope_percent: f32,
    /// Variance of its fast error as it is assumed, %².
    pub fast_variance: f32,
    pub time: Instant,
    /// Slope that the sensor observes (of the road, or as the model reads it) by the filter, %, and its
    /// variance, %².
    pub known_percent: f32,
    pub known_variance: f32,
    /// Specific force along the vehicle, m/s².
    pub felt_mps2: f32,
    /// Part of the difference to the estimate that its scale explains, %, and its variance, %².
    pub by_scale_percent: f32,
    pub by_scale_variance: f32,
    /// Whether the force model holds.
    pub holds: bool,
}

/// What a reading shows.
#[derive(Clone, Copy, Debug)]
pub(super) struct Innovation {
    pub percent: f32,
    /// Variance of the fast error, as of one that is new at each reading, %².
    pub fast_variance: f32,
    /// Variance of offset and gain, %².
    pub slow_variance: f32,
    /// Time since the last reading, s, 0.01 at least.
    pub spaced_s: f32,
    /// Learned over assumed variance of the fast error.
    pub ratio: f32,
}

/// What becomes of a reading.
#[derive(Clone, Copy, Debug)]
pub(super) enum Verdict {
    /// It is used.
    Use(Innovation),
    /// The sensor is not known yet.
    Learn,
    /// It disagrees, or its sensor does.
    Reject,
}

/// How far a sensor is known.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Standing {
    /// Not yet.
    Learning,
    /// It does not measure a slope.
    Wrong,
    /// Well enough to be used, and to be kept.
    Known,
}

/// What is known of a sensor.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sensor {
    noise: NoiseRatio,
    offset_percent: f32,
    gain: f32,
    offset_variance: f32,
    gain_variance: f32,
    covariance: f32,
    factor: Factor,
    offset_origin: OffsetOrigin,
    learned_s: f32,
    last_time: Instant,
    last_percent: f32,
    unchanged_s: f32,
}

/// What a sensor reads for a slope of 1 %: sums of a weighted regression on the slope of the estimate.
#[derive(Clone, Copy, Debug)]
struct Factor {
    weight: f32,
    product: f32,
}

impl Factor {
    /// One, give or take a thousand.
    const UNKNOWN: Self = Self {
        weight: 1e-6,
        product: 1e-6,
    };

    /// One, known twice as well as it has to be.
    const KNOWN: Self = Self {
        weight: 4.0 / (FACTOR_SIGMA * FACTOR_SIGMA),
        product: 4.0 / (FACTOR_SIGMA * FACTOR_SIGMA),
    };

    /// Takes a reading less offset and gain, beside the slope of the estimate, with the variance of
    /// their difference.
    fn learn(&mut self, read: f32, known: f32, variance: f32) {
        self.weight = FACTOR_KEEP * self.weight + known * known / variance;
        self.product = FACTOR_KEEP * self.product + known * read / variance;
    }

    /// Returns its sigma.
    fn sigma(&self) -> f32 {
        1.0 / Scalar::sqrt(self.weight)
    }

    /// Returns whether it may be one.
    fn may_be_one(&self) -> bool {
        let error = self.product / self.weight - 1.0;
        error.abs() < FACTOR_ERROR + 3.0 * self.sigma()
    }
}

impl Sensor {
    pub(super) fn new(assumed: &Assumed) -> Self {
        Self {
            noise: NoiseRatio::new(1.0, RATIO_LOW, RATIO_HIGH, RATIO_GAIN),
            offset_percent: 0.0,
            gain: assumed.gain,
            offset_variance: assumed.offset_sigma_percent * assumed.offset_sigma_percent,
            gain_variance: assumed.gain_sigma * assumed.gain_sigma,
            covariance: 0.0,
            factor: Factor::UNKNOWN,
            offset_origin: OffsetOrigin::Model,
            learned_s: 0.0,
            last_time: Instant::ZERO,
            last_percent: f32::NAN,
            unchanged_s: 0.0,
        }
    }

    /// Starts with what an earlier drive left. The sigma of the fast error is assumed to be this one,
    /// before anything is learned, %.
    pub(super) fn resume(&mut self, kept: &BodySensor, sigma_percent: f32) {
        self.noise
            .set(variance_ratio(kept.noise_sigma, sigma_percent));
        self.offset_percent = kept.offset;
        self.offset_variance = kept.offset_variance;
        self.gain = kept.gain;
        self.gain_variance = kept.gain_variance;
        self.factor = Factor::KNOWN;
        self.learned_s = LEARNING_S;
        self.offset_origin = OffsetOrigin::LevelRoad;
    }

    /// Returns what this drive leaves, if the sensor may be used. `model_error` is the slow error of
    /// the model, %, with its variance, %².
    pub(super) fn kept(
        &self,
        assumed: &Assumed,
        sigma_percent: f32,
        model_error: (f32, f32),
    ) -> Option<BodySensor> {
        if self.standing(assumed) != Standing::Known {
            return None;
        }
        let learned = BodySensor {
            offset: self.offset_percent,
            offset_variance: self.offset_variance,
            gain: self.gain,
            gain_variance: self.gain_variance,
            noise_sigma: learned_sigma(self.noise.ratio(), sigma_percent),
        };
        Some(self.offset_origin.kept(learned, model_error))
    }

    /// Makes a kept offset one beside the model of this drive, whose slow error is this one, %, with
    /// its variance, %².
    #[inline]
    pub(super) fn relate(&mut self, (error_percent, variance): (f32, f32)) {
        if self.offset_origin == OffsetOrigin::LevelRoad {
            self.offset_percent -= error_percent;
            self.offset_variance += variance;
            self.offset_origin = OffsetOrigin::Model;
        }
    }

    /// Returns what is known of it for a second pass over the same drive.
    pub(super) fn second_pass(&self) -> Self {
        Self {
            last_time: Instant::ZERO,
            last_percent: f32::NAN,
            unchanged_s: 0.0,
            ..*self
        }
    }

    /// Widens offset and gain by a variance of the offset, %², and up to what is always unknown.
    pub(super) fn widen(&mut self, assumed: &Assumed, offset_variance: f32) {
        let least = |sigma: f32, variance: f32| Scalar::max(variance, sigma * sigma);
        let offset_variance = self.offset_variance + offset_variance;
        self.offset_variance = least(assumed.least_offset_sigma_percent, offset_variance);
        self.gain_variance = least(assumed.least_gain_sigma, self.gain_variance);
    }

    /// Compares a reading with the estimate, and learns from it where the model holds.
    pub(super) fn compare(
        &mut self,
        assumed: &Assumed,
        reading: &Reading,
        tuning: &MeasurementNoise,
    ) -> Verdict {
        let since_s = reading.time.seconds_since(self.last_time);
        self.last_time = reading.time;
        if self.is_stuck(reading.slope_percent, since_s) {
            return Verdict::Reject;
        }
        let spaced_s = Scalar::min(FAST_ERROR_S, Scalar::max(0.01, since_s));
        let felt = reading.felt_mps2;
        let expected = self.offset_percent + self.gain * felt + reading.by_scale_percent;
        let [offset_cross, gain_cross] = [
            self.offset_variance + self.covariance * felt,
            self.covariance + self.gain_variance * felt,
        ];
        let slow_variance =
            Scalar::max(0.0, offset_cross + gain_cross * felt) + reading.by_scale_variance;
        let ratio = self.noise.ratio();
        // As if it were new each time.
        let fast_variance = ratio * reading.fast_variance * FAST_ERROR_S / spaced_s;
        let innovation = reading.slope_percent - reading.known_percent - expected;
        let noise = fast_variance + reading.known_variance;
        let normalised = innovation * innovation / (noise + slow_variance);
        if reading.holds {
            self.noise.learn(normalised, tuning.largest_innovation);
            let per_variance = 1.0 / (COLOUR * noise + slow_variance);
            let (offset_gain, gain_gain) = (offset_cross * per_variance, gain_cross * per_variance);
            self.offset_percent += offset_gain * innovation;
            self.gain += gain_gain * innovation;
            self.offset_variance -= offset_gain * offset_cross;
            self.covariance -= offset_gain * gain_cross;
            self.gain_variance -= gain_gain * gain_cross;
            let read = reading.slope_percent - expected;
            self.factor.learn(read, reading.known_percent, noise);
            self.learned_s += spaced_s;
        }
        match self.standing(assumed) {
            Standing::Learning => Verdict::Learn,
            Standing::Wrong => Verdict::Reject,
            Standing::Known if normalised > tuning.largest_innovation => Verdict::Reject,
            Standing::Known => Verdict::Use(Innovation {
                percent: innovation,
                fast_variance,
                slow_variance,
                spaced_s,
                ratio,
            }),
        }
    }

    fn standing(&self, assumed: &Assumed) -> Standing {
        if self.learned_s < LEARNING_S {
            Standing::Learning
        } else if !self.may_be_right(assumed) {
            Standing::Wrong
        } else if self.factor.sigma() > FACTOR_SIGMA {
            Standing::Learning
        } else {
            Standing::Known
        }
    }

    /// Returns whether unit, sign and axis may be those of a slope. At a steady speed the gain explains any
    /// unit, so that it has to be one that a body can have.
    fn may_be_right(&self, assumed: &Assumed) -> bool {
        let gain = self.gain - assumed.gain;
        self.factor.may_be_one() && gain.abs() <= 3.0 * assumed.gain_sigma
    }

    /// Returns whether the readings have been the same to the last digit for long.
    fn is_stuck(&mut self, percent: f32, since_s: f32) -> bool {
        if percent == self.last_percent {
            self.unchanged_s += since_s;
        } else {
            self.last_percent = percent;
            self.unchanged_s = 0.0;
        }
        self.unchanged_s > FROZEN_S
    }
}
