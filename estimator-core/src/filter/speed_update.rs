//! The update with the wheel speed.

use super::measurement::{Observation, ScalarMeasurement, ScalarUpdate};
use super::noise_ratio::{NoiseRatio, SensorNoiseRatios};
use super::slope_step::SlopeStep;
use super::state::State;
use super::state_index::StateIndex;
use super::step_record::Reset;
use crate::context::Context;
use crate::counters::count;
use crate::sample::{Sample, SpeedMeasurement};
use crate::scalar::Scalar;
use crate::tuning::{MeasurementNoise, Tuning};
use crate::vehicle::GRAVITY;

/// Change of the acceleration of a vehicle that shifts or launches, m/s³: chosen.
const JERK_MPS3: f32 = 2.0;

/// Time between two readings after which the speed may be any, s.
const LONG_S: f32 = 10.0;

/// Difference of two measurements of the speed above which it is no noise, in sigmas.
const DIFFERING_SIGMAS: f32 = 2.0;

/// Kinetic energy at the start of a cell.
#[derive(Clone, Copy, Debug)]
pub(super) struct EnergyBefore<S> {
    /// Mean, m²/s².
    pub mean: S,
    /// Variance, (m²/s²)².
    pub variance: S,
}

impl<S: Scalar> EnergyBefore<S> {
    pub(super) fn of(state: &State<S>) -> Self {
        Self {
            mean: state.mean[StateIndex::KineticEnergy],
            variance: state.covariance.variance(StateIndex::KineticEnergy),
        }
    }
}

/// What the filter remembers for the speed updates.
#[derive(Clone, Debug)]
pub(super) struct SpeedUpdate {
    noise: NoiseRatio,
    /// Learned over assumed variance of the force.
    force_ratio: f32,
    /// Weighted sum of the innovations over their sigmas, of variance 1 if they are white.
    innovations_before: f32,
    steps: SlopeStep,
    has_stepped: bool,
    /// Distance since the last speed up to the last cell, m.
    unmeasured_m: f32,
}

impl SpeedUpdate {
    /// Creates the memory with the noise known so far.
    pub(super) fn new(noise: &SensorNoiseRatios, tuning: &Tuning) -> Self {
        let gates = &tuning.gates;
        let tuning = &tuning.measurement_noise;
        Self {
            noise: NoiseRatio::new(
                noise.speed,
                tuning.speed_ratio_low,
                tuning.speed_ratio_high,
                tuning.speed_ratio_gain,
            ),
            force_ratio: 1.0,
            innovations_before: 0.0,
            steps: SlopeStep::new(gates),
            has_stepped: false,
            unmeasured_m: 0.0,
        }
    }

    /// Returns the memory for a second pass over the same drive.
    pub(super) fn second_pass(&self, noise: &SensorNoiseRatios, tuning: &Tuning) -> Self {
        Self {
            force_ratio: self.force_ratio,
            ..Self::new(noise, tuning)
        }
    }

    /// Returns learned over assumed variance of the white noise of the force.
    pub(super) const fn force_ratio(&self) -> f32 {
        self.force_ratio
    }

    /// Returns whether the slope stepped in the last cell.
    pub(super) fn take_step(&mut self) -> bool {
        core::mem::take(&mut self.has_stepped)
    }

    /// Learns the noise of the force. Noise of the readings leaves successive innovations
    /// uncorrelated, or makes them alternate; a force that the model lacks moves them the same way
    /// (Mehra 1970). A force that is late moves them one way and soon back, so that an innovation is
    /// compared with a weighted sum of those before it.
    fn learn_force(&mut self, innovation: f32, tuning: &MeasurementNoise) {
        let product = innovation * self.innovations_before;
        let keep = tuning.force_memory;
        let new = Scalar::sqrt(1.0 - keep * keep) * innovation;
        self.innovations_before = keep * self.innovations_before + new;
        let bounded = Scalar::min(3.0, Scalar::max(-3.0, product));
        let factor = 1.0 + tuning.force_ratio_gain * (bounded - tuning.force_correlation);
        self.force_ratio = Scalar::min(
            tuning.force_ratio_high,
            Scalar::max(1.0, self.force_ratio * factor),
        );
    }

    /// Returns learned over assumed variance of a reading.
    pub(super) const fn noise_ratio(&self) -> f32 {
        self.noise.ratio()
    }

    /// Updates the state with the speed of a sample, if there is one.
    #[inline]
    pub(super) fn apply<S: Scalar>(
        &mut self,
        context: &mut Context,
        sample: &Sample,
        state: &mut State<S>,
        before: EnergyBefore<S>,
        reset: Reset,
    ) -> Option<ScalarUpdate<S>> {
        let Some(speed) = sample.speed else {
            self.unmeasured_m += sample.length_m;
            return None;
        };
        let tuning = &context.tuning;
        let distance_m = core::mem::take(&mut self.unmeasured_m) + sample.length_m;
        let spaced = (speed, distance_m);
        let measurement = at_end(state, tuning, sample, spaced, before, self.noise.ratio());
        if is_step(state, tuning, distance_m, &measurement) {
            // Of the speed, and not of what moves it. The step is in the sensor.
            let variance = measurement.innovation.squared();
            let energy = StateIndex::KineticEnergy;
            state.covariance.add_variance(energy, variance);
            count(&mut context.counters.speed_steps);
        }
        let update = measurement.apply(state);
        let condition = sample.end.condition;
        let normalised = update.normalised_squared();
        if reset == Reset::None && condition.is_valid() && !condition.crawling {
            let largest = tuning.measurement_noise.largest_innovation;
            self.noise.learn(normalised.to_f32(), largest);
            let sigma = update.innovation_variance.sqrt();
            let innovation = (update.innovation / sigma).to_f32();
            self.learn_force(innovation, &tuning.measurement_noise);
            self.has_stepped = self.steps.add(innovation, &tuning.gates);
        } else {
            self.steps.restart();
        }
        Some(update)
    }
}

/// Returns whether the speed differs by more than noise, road and brakes can make over the distance
/// since the last one: the sensor slipped, stuck or was replaced.
fn is_step<S: Scalar>(
    state: &State<S>,
    tuning: &Tuning,
    distance_m: f32,
    measurement: &ScalarMeasurement<S>,
) -> bool {
    let innovation = measurement.innovation.to_f32();
    let predicted = state.covariance.variance(StateIndex::KineticEnergy);
    let variance = (predicted + measurement.variance).to_f32();
    let most = || 0.01 * GRAVITY * tuning.process_noise.invalid_noise_percent * distance_m;
    innovation * innovation > tuning.gates.speed_test_ratio * variance && innovation.abs() > most()
}

/// Returns the speed as a measurement of v²/2 at the cell's end.
///
/// The predicted change of the energy carries the mean of the readings there. Where the forces are not
/// known (a clutch that slips, a launch with another load), it carries it to a wrong energy. The reading
/// at the end then counts, as far as the two differ by more than two sigmas (the positive part of W. James
/// and C. Stein, "Estimation with quadratic loss", Berkeley Symposium 1:361, 1961). `distance_m` is that
/// since the readings before.
fn at_end<S: Scalar>(
    state: &State<S>,
    tuning: &Tuning,
    sample: &Sample,
    (speed, distance_m): (SpeedMeasurement, f32),
    before: EnergyBefore<S>,
    noise_ratio: f32,
) -> ScalarMeasurement<S> {
    let energy = state.mean[StateIndex::KineticEnergy];
    let gained = state.covariance.variance(StateIndex::KineticEnergy) - before.variance;
    let per_length = S::from_f32(1.0 / sample.length_m);
    let gradient = (energy - before.mean) * per_length;
    let mean = measurement(state, tuning, speed, gradient, noise_ratio);
    let behind = S::from_f32(speed.behind_m) * per_length;
    let carried = behind * behind * gained;
    let count = f32::from(speed.count.max(1));
    let apart_s = sample.duration_s * distance_m / (sample.length_m * count);
    let mps = sample.end.speed_mps;
    let bend = mps * bend_mps(Scalar::min(LONG_S, apart_s));
    let of_last = mean.variance * S::from_f32(count) + S::from_f32(bend * bend);
    // A brake acts alike over many cells: what the speed gains from one to the next is right.
    if sample.end.condition.braking || mean.variance + carried <= of_last {
        return mean;
    }
    let last = S::from_f32(0.5 * mps * mps) - energy;
    towards(mean, last, of_last)
}

/// Returns a measurement that is moved towards another innovation of such a variance, as far as the
/// two differ by more than [`DIFFERING_SIGMAS`].
#[inline(never)] // Rare.
fn towards<S: Scalar>(
    measurement: ScalarMeasurement<S>,
    innovation: S,
    variance: S,
) -> ScalarMeasurement<S> {
    let differing = innovation - measurement.innovation;
    let noise =
        S::from_f32(DIFFERING_SIGMAS * DIFFERING_SIGMAS) * (variance + measurement.variance);
    let differing_squared = differing.squared();
    if differing_squared <= noise {
        return measurement;
    }
    let weight = S::ONE - noise / differing_squared;
    ScalarMeasurement {
        innovation: measurement.innovation + weight * differing,
        variance: measurement.variance + weight * (variance - measurement.variance),
        ..measurement
    }
}

/// Returns by how much the speed bends between two readings, m/s.
const fn bend_mps(apart_s: f32) -> f32 {
    0.125 * JERK_MPS3 * apart_s * apart_s
}

/// Returns the mean speed as a measurement of v²/2 at the cell's end. `gradient` is the predicted
/// change of energy along the road, m²/s² per m, which carries the measurement there.
fn measurement<S: Scalar>(
    state: &State<S>,
    tuning: &Tuning,
    speed: SpeedMeasurement,
    gradient: S,
    noise_ratio: f32,
) -> ScalarMeasurement<S> {
    let mps = speed.mean_mps;
    let sigma = if mps < tuning.detection.crawl_mps {
        tuning.measurement_noise.crawl_speed_sigma_mps
    } else {
        tuning.measurement_noise.speed_sigma_mps
    };
    let measured = S::from_f32(0.5 * mps * mps) + gradient * S::from_f32(speed.behind_m);
    let sigma_squared = noise_ratio * sigma * sigma;
    // Steps are the same for all readings of a cell: their mean is no better than one of them.
    let step_variance = speed.resolution_mps * speed.resolution_mps / 12.0;
    let variance = mps * mps * (sigma_squared / f32::from(speed.count.max(1)) + step_variance);
    ScalarMeasurement {
        observation: Observation::Energy,
        innovation: measured - state.mean[StateIndex::KineticEnergy],
        // d(v²/2) = v dv, and dv²/2 where v is no larger than its noise.
        variance: S::from_f32(variance + 0.5 * sigma_squared * sigma_squared),
    }
}
