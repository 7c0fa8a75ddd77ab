//! The update with a slope that a sensor measures directly.
//!
//! The vertical speed of a GNSS receiver comes from Doppler shifts, so that it knows nothing of the
//! drifts of the altitude. The pitch of the body has an offset (the tilt of the sensor, the load), and
//! its springs give way. Both errors are relative to the model, so that a pitch serves only where the
//! model does not hold.
//!
//! No state of the filter describes the slow errors of these sensors. They limit the information of a
//! measurement instead ([`bounded_variance`]).
//!
//! | file | content |
//! |---|---|
//! | `sensor` | noise, offset and gain of a sensor, learned where the model holds |

mod sensor;

use super::body_sensor::BodySensor;
use super::measurement::{Observation, ScalarMeasurement};
use super::state::State;
use super::state_index::StateIndex::{KineticEnergy, Scale, SlopeRate};
use crate::context::Context;
use crate::counters::count;
use crate::sample::{Sample, SlopeMeasurement, SlopeSensor};
use crate::scalar::Scalar;
use crate::tuning::Prior;
use crate::vehicle::GRAVITY;
use sensor::{Assumed, Innovation, Reading, Sensor, Verdict};

/// Fast error of a vertical speed, 1 sigma, m/s. Receivers state 0.05 of a horizontal speed; the
/// geometry of the satellites makes the vertical one worse.
const VERTICAL_SPEED_SIGMA_MPS: f32 = 0.1;
/// Its slow error (ionosphere, orbits, reflections) as a part of the fast one, and the time for which
/// it keeps its value, s.
const SLOW_PART: f32 = 0.3;
const SLOW_ERROR_S: f32 = 30.0;
/// Time by which it may be later than the position of its fix, s: a receiver filters it.
const LATE_S: f32 = 0.5;
/// A vertical speed has no offset.
const VERTICAL_SPEED: Assumed = Assumed {
    offset_sigma_percent: 0.0,
    gain: 0.0,
    gain_sigma: 0.0,
    least_offset_sigma_percent: 0.0,
    least_gain_sigma: 0.0,
};

/// Fast error of a pitch, 1 sigma, %: a body that swings by 0.3°.
const PITCH_SIGMA_PERCENT: f32 = 0.5;
/// Walk of its offset, %² over a metre: 0.1 % over a kilometre. It is that against the estimate, whose
/// slow error changes within kilometres.
const PITCH_WALK: f32 = 0.1 * 0.1 / 1_000.0;
/// Change of its offset after a load change, %.
const PITCH_LOAD_PERCENT: f32 = 0.5;
/// A sensor is mounted to within two degrees; a body on springs pitches by 0.3° for each m/s².
const PITCH: Assumed = Assumed {
    offset_sigma_percent: 3.0,
    gain: 0.5,
    gain_sigma: 0.5,
    least_offset_sigma_percent: 0.1,
    least_gain_sigma: 0.05,
};

/// Longest way for which a measurement waits, in cells: the road does not bend over it.
const LONGEST_WAIT: f32 = 2.5;
/// Largest variance of a measurement that is used, %².
const LARGEST_VARIANCE: f32 = 1e3;

/// What the filter remembers for the slope updates.
#[derive(Clone, Debug)]
pub(super) struct SlopeUpdate {
    vertical_speed: Sensor,
    pitch: Sensor,
    /// A measurement that waits for a cell without another one, and for how long, m.
    waiting: Option<(SlopeMeasurement, f32)>,
}

impl SlopeUpdate {
    /// Creates the memory before the first measurement.
    #[inline(always)] // See Estimator::new_in().
    pub(super) fn new() -> Self {
        Self {
            vertical_speed: Sensor::new(&VERTICAL_SPEED),
            pitch: Sensor::new(&PITCH),
            waiting: None,
        }
    }

    /// Starts with what an earlier drive left of the pitch sensor, before the first sample. The load
    /// is another one as rarely as for the scale.
    pub(super) fn resume(&mut self, kept: &BodySensor, tuning: &Prior) {
        let other_load = 1.0 - tuning.kept_scale * tuning.kept_scale;
        let variance = other_load * PITCH_LOAD_PERCENT * PITCH_LOAD_PERCENT;
        self.pitch
            .resume(&kept.moved(0.0, variance), PITCH_SIGMA_PERCENT);
    }

    /// Returns what this drive leaves of the pitch sensor, if it is trusted.
    pub(super) fn kept<S: Scalar>(&self, state: &State<S>) -> Option<BodySensor> {
        self.pitch
            .kept(&PITCH, PITCH_SIGMA_PERCENT, state.model_error())
    }

    /// Returns the memory for a second pass over the same drive.
    pub(super) fn second_pass(&self) -> Self {
        Self {
            vertical_speed: self.vertical_speed.second_pass(),
            pitch: self.pitch.second_pass(),
            waiting: None,
        }
    }

    /// Takes the measurement of a sample. Returns whether one has waited for so long that it goes
    /// before an altitude.
    #[inline]
    pub(super) fn take(&mut self, sample: &Sample) -> bool {
        if sample.slope.is_none() && self.waiting.is_none() {
            return false;
        }
        self.queue(sample)
    }

    #[inline(never)] // Not for the vehicles without such a sensor.
    fn queue(&mut self, sample: &Sample) -> bool {
        self.pitch.widen(&PITCH, walk(sample));
        let waited_m = self.waiting.map_or(0.0, |(_, m)| m + sample.length_m);
        let vertical = |measured: &SlopeMeasurement| measured.sensor == SlopeSensor::VerticalSpeed;
        let last = self.waiting.map(|(measured, _)| measured);
        // A pitch comes again with the next cell, a vertical speed does not.
        self.waiting = sample
            .slope
            .filter(vertical)
            .or(last.filter(vertical))
            .or(sample.slope)
            .or(last)
            .filter(|_| sample.gap_cells == 0)
            .map(|measured| (measured, waited_m));
        waited_m > LONGEST_WAIT * sample.length_m
    }

    /// Returns the measurement that waits, if it is of use. `energy_before` is the kinetic energy at
    /// the start of the cell, m²/s².
    #[inline]
    pub(super) fn measurement<S: Scalar>(
        &mut self,
        context: &mut Context,
        sample: &Sample,
        state: &State<S>,
        energy_before: S,
    ) -> Option<ScalarMeasurement<S>> {
        let (measured, _) = self.waiting.take()?;
        self.compare(context, sample, state, energy_before, measured)
    }

    #[inline(never)] // Not for the vehicles without such a sensor.
    fn compare<S: Scalar>(
        &mut self,
        context: &mut Context,
        sample: &Sample,
        state: &State<S>,
        energy_before: S,
        measured: SlopeMeasurement,
    ) -> Option<ScalarMeasurement<S>> {
        let tuning = &context.tuning.measurement_noise;
        let reading = reading(sample, state, energy_before, measured);
        let verdict = match measured.sensor {
            SlopeSensor::VerticalSpeed => {
                let sensor = &mut self.vertical_speed;
                sensor.compare(&VERTICAL_SPEED, &reading, tuning)
            }
            SlopeSensor::Pitch => {
                self.pitch.relate(state.model_error());
                self.pitch.compare(&PITCH, &reading, tuning)
            }
        };
        let seen = match verdict {
            Verdict::Use(seen) => seen,
            Verdict::Learn => return None,
            Verdict::Reject => {
                count(&mut context.counters.slopes_rejected);
                return None;
            }
        };
        let variance = match measured.sensor {
            SlopeSensor::VerticalSpeed => {
                vertical_speed_variance(&reading, &seen, late_variance(sample, state))
            }
            // The force model is better where it holds.
            SlopeSensor::Pitch if reading.holds => return None,
            SlopeSensor::Pitch => bounded_variance(
                reading.known_variance,
                seen.fast_variance,
                seen.slow_variance,
            ),
        };
        if variance > LARGEST_VARIANCE {
            return None;
        }
        count(&mut context.counters.slopes_used);
        Some(ScalarMeasurement {
            observation: observation(measured.sensor),
            innovation: S::from_f32(seen.percent),
            variance: S::from_f32(variance),
        })
    }
}

/// Returns what a sensor observes. The offset of a pitch is relative to what the model reads.
const fn observation(sensor: SlopeSensor) -> Observation {
    match sensor {
        SlopeSensor::VerticalSpeed => Observation::RoadSlope,
        SlopeSensor::Pitch => Observation::ModelSlope,
    }
}

/// Returns a measurement beside what the filter knows of the cell.
fn reading<S: Scalar>(
    sample: &Sample,
    state: &State<S>,
    energy_before: S,
    measured: SlopeMeasurement,
) -> Reading {
    let (known_percent, known_variance) = state.observed(observation(measured.sensor));
    let gained_mps2 = (state.mean[KineticEnergy] - energy_before).to_f32() / sample.length_m;
    let felt_mps2 = gained_mps2 + 0.01 * GRAVITY * known_percent;
    let net_traction = state.net_traction.to_f32();
    // What a vertical speed observes contains the scale. The gain of a pitch is learned where net
    // traction and specific force are alike, so that an error of the scale is in it; the pitch is used
    // where they differ.
    let (sigma_percent, scale_factor, scale_error_factor) = match measured.sensor {
        SlopeSensor::VerticalSpeed => {
            let sigma_percent = 100.0 * VERTICAL_SPEED_SIGMA_MPS / sample.end.speed_mps;
            (sigma_percent, 0.0, 0.0)
        }
        SlopeSensor::Pitch => {
            let differing = net_traction - 100.0 / GRAVITY * felt_mps2;
            (PITCH_SIGMA_PERCENT, net_traction, differing)
        }
    };
    let scale_variance = state.covariance.variance(Scale).to_f32();
    let condition = sample.end.condition;
    Reading {
        slope_percent: measured.slope_percent,
        fast_variance: sigma_percent * sigma_percent,
        time: sample.end.time,
        known_percent,
        known_variance,
        felt_mps2,
        by_scale_percent: scale_factor * state.mean[Scale].to_f32(),
        by_scale_variance: scale_error_factor * scale_error_factor * scale_variance,
        holds: condition.is_valid() && !condition.crawling,
    }
}

/// Returns the variance that the offset of a pitch gains over a cell, %².
fn walk(sample: &Sample) -> f32 {
    let load = if sample.after_stop || sample.after_load_change {
        PITCH_LOAD_PERCENT * PITCH_LOAD_PERCENT
    } else {
        0.0
    };
    PITCH_WALK * sample.length_m + load
}

/// Returns the variance by which the slope changes over the way for which a vertical speed may be late,
/// %².
fn late_variance<S: Scalar>(sample: &Sample, state: &State<S>) -> f32 {
    let late_m = LATE_S * sample.end.speed_mps;
    let rate = state.mean[SlopeRate].to_f32();
    let variance = state.covariance.variance(SlopeRate).to_f32();
    late_m * late_m * (rate * rate + variance)
}

/// Returns the variance of a vertical speed as a measurement, %². `late` is that of being late, which
/// is alike in readings that follow each other, and averages out as hills do.
///
/// In the long run its slow error averages out as white noise of the same power does. For a while it
/// keeps its value. Either bound holds, so the smaller variance counts.
fn vertical_speed_variance(reading: &Reading, seen: &Innovation, late: f32) -> f32 {
    let slow = SLOW_PART * SLOW_PART * seen.ratio * reading.fast_variance + late;
    let in_the_long_run = seen.fast_variance + slow * 2.0 * SLOW_ERROR_S / seen.spaced_s;
    let for_a_while = bounded_variance(reading.known_variance, seen.fast_variance, slow);
    Scalar::min(in_the_long_run, for_a_while)
}

/// Returns the variance of a measurement whose slow error may be the same as in those before it, %².
///
/// What is measured never becomes better known than the slow error is: 1/P + 1/R stays below 1/slow
/// with R = max(fast, slow) P / (P - slow). Where P is no larger than that, there is no news.
fn bounded_variance(known: f32, fast: f32, slow: f32) -> f32 {
    let beyond = known - slow;
    if beyond > 0.0 {
        Scalar::max(fast, slow) * known / beyond
    } else {
        f32::INFINITY
    }
}
