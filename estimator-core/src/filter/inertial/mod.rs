//! The accelerometer as a second measurement of the force.
//!
//! An accelerometer along the vehicle reads the change of speed plus the gravity along the road. The
//! force model computes the same sum from torque and resistance, so that the accelerometer measures
//! the input of the prediction, cell by cell, without a difference of speeds. Both are combined by
//! their variances: where the model holds, it is better by a factor of ten or more; where it does
//! not (shifts, brakes, launches, missing torque), the accelerometer stands in. Filter and smoother
//! see another input, another F and another Q, and need no state more.
//!
//! | file | content |
//! |---|---|
//! | `slow_errors` | offset, pitch under acceleration, and scale, learned where the model holds |
//! | `unchanged_traction` | for how long the traction stays the same to the last digit |
//! | `weighing` | the scale that it shows, as a measurement of the filter |
//! | `next_drive` | what it leaves for the next drive |
//! | `alone` | what the state must know where the accelerometer stands in |
//! | `frozen_reading` | whether the readings are stuck |
//! | `force_test` | whether force and accelerometer agree |

mod alone;
mod force_test;
mod frozen_reading;
mod next_drive;
mod slow_errors;
mod unchanged_traction;
mod weighing;

use super::body_sensor::OffsetOrigin;
use super::measurement::ScalarMeasurement;
use super::noise_ratio::NoiseRatio;
use super::predict::{MeasuredMotion, ModelMotion, Prediction};
use super::process_noise::wind_variance;
use super::state::State;
use super::state_index::StateIndex::Scale;
use crate::cell::Condition;
use crate::context::Context;
use crate::counters::count;
use crate::sample::{InertialMeasurement, Sample};
use crate::scalar::Scalar;
use crate::tuning::{Inertial, Tuning};
use crate::vehicle::GRAVITY;
use alone::{Alone, PERCENT_PER_MPS2};
use force_test::{Finding, ForceTest, Innovation};
use frozen_reading::FrozenReading;
use slow_errors::{ForcesPerMass, Regressors, SlowErrors};
use weighing::Weighing;

/// Sigma up to which an accelerometer goes on standing in, over that up to which it begins to.
const STAYS: f32 = 1.5;

/// What is known of the accelerometer.
#[derive(Clone, Copy, Debug)]
pub(super) struct Accelerometer {
    errors: SlowErrors,
    noise: NoiseRatio,
    test: ForceTest,
    /// Distance over which the errors were learned, m.
    learned_m: f32,
    is_trusted: bool,
    offset_origin: OffsetOrigin,
    reading: FrozenReading,
    alone: Alone,
    /// Distance over which the force is not believed, less that since, m.
    doubted_m: f32,
    /// Variance of the change of speed by the model where it last held, (m/s²)².
    model_variance: f32,
    weighing: Weighing,
}

impl Accelerometer {
    /// Creates it before its first reading.
    #[inline(always)] // See Estimator::new_in().
    pub(super) fn new(tuning: &Tuning) -> Self {
        let tuning = &tuning.inertial;
        Self {
            errors: SlowErrors::new(tuning),
            noise: NoiseRatio::new(1.0, tuning.ratio_low, tuning.ratio_high, tuning.ratio_gain),
            test: ForceTest::new(),
            learned_m: 0.0,
            is_trusted: false,
            offset_origin: OffsetOrigin::Model,
            reading: FrozenReading::new(),
            alone: Alone::default(),
            doubted_m: 0.0,
            model_variance: 0.0,
            weighing: Weighing::default(),
        }
    }

    /// Returns what is known for a second pass over the same drive. The offset may have been another
    /// one at its start.
    pub(super) fn second_pass(&self, tuning: &Tuning) -> Self {
        let mut errors = self.errors;
        let changed = tuning.inertial.changed_offset_sigma_mps2;
        errors.walk(changed * changed, &tuning.inertial);
        errors.open_scale(tuning.prior.open_scale_sigma);
        Self {
            errors,
            noise: self.noise,
            learned_m: self.learned_m,
            is_trusted: self.is_trusted,
            offset_origin: self.offset_origin,
            ..Self::new(tuning)
        }
    }

    /// Returns whether the accelerometer shows that the force of a sample is wrong.
    #[inline]
    pub(super) fn doubts_force(&self, sample: &Sample) -> bool {
        self.test.disagrees() && sample.inertial.is_some()
    }

    /// Returns whether it stood in for the model up to the last cell.
    pub(super) fn stood_in(&self) -> bool {
        self.alone.is_on()
    }

    /// Opens the scale: the load may be another one.
    pub(super) fn open_scale(&mut self, tuning: &Tuning) {
        self.errors.open_scale(tuning.prior.open_scale_sigma);
        self.weighing = Weighing::default();
    }

    /// Widens the state by what it does not know yet of the accelerometer's errors.
    #[inline]
    pub(super) fn widen<S: Scalar>(&mut self, state: &mut State<S>) {
        self.alone.widen(state);
    }

    /// Combines the prediction over the cell of a sample with the accelerometer, and learns from
    /// their difference. `reported` is the condition without what the accelerometer says of it.
    /// Returns the number of cells in which force and accelerometer disagree, up to this one.
    #[inline]
    pub(super) fn advance<S: Scalar>(
        &mut self,
        context: &mut Context,
        sample: &Sample,
        reported: Condition,
        state: Option<&State<S>>,
        prediction: &mut Prediction<S>,
    ) -> Option<u32> {
        match (&sample.inertial, state) {
            (Some(measured), Some(state)) if sample.gap_cells == 0 => {
                self.measure(context, sample, reported, state, prediction, measured)
            }
            _ => {
                if self.is_known() {
                    self.interrupt(&context.tuning);
                }
                None
            }
        }
    }

    /// Returns whether anything of it is known.
    fn is_known(&self) -> bool {
        self.is_trusted || self.learned_m > 0.0
    }

    fn offset_variance(&self) -> f32 {
        let (_, variance) =
            self.errors
                .expected(Regressors::new(0.0, 0.0, ForcesPerMass::default()));
        variance
    }

    /// Notes a cell without a reading.
    #[inline(never)] // Vehicles without one do not pay for it.
    fn interrupt(&mut self, tuning: &Tuning) {
        self.test.restart();
        self.alone.believe();
        self.alone.end(self.offset_variance(), &tuning.inertial);
        self.doubted_m = 0.0;
    }

    #[inline(never)] // Vehicles without one do not pay for it.
    fn measure<S: Scalar>(
        &mut self,
        context: &mut Context,
        sample: &Sample,
        reported: Condition,
        state: &State<S>,
        prediction: &mut Prediction<S>,
        measured: &InertialMeasurement,
    ) -> Option<u32> {
        let tuning = &context.tuning.inertial;
        if self.reading.is_frozen(measured, tuning) {
            self.reject(context);
            return None;
        }
        if self.offset_origin == OffsetOrigin::LevelRoad {
            self.relate(state, &context.tuning.inertial);
        }
        self.walk(sample, prediction, &context.tuning);
        let motion = prediction.motion(state, sample.length_m);
        let own_variance = self.own_variance(measured, &context.tuning.inertial);
        let holds = reported.is_valid() && !reported.crawling;
        let mut disagreeing = None;
        if holds {
            if !self.test.disagrees() {
                self.model_variance = motion.variance;
            }
            let forces = forces_per_mass(context, sample, &motion);
            let regressors = Regressors::new(motion.felt_mps2, motion.change_mps2, forces);
            let (expected_mps2, expected_variance) = self.errors.expected(regressors);
            let innovation = Innovation {
                mps2: measured.acceleration_mps2 - motion.felt_mps2 - expected_mps2,
                white_variance: own_variance + self.model_variance,
                expected_variance,
            };
            self.test.note_traction(sample, &context.model.vehicle);
            if self.is_trusted {
                // Gusts and slipstreams move a light vehicle against its accelerometer. They are no
                // error of the torque.
                let wind_percent2 = wind_variance(context, sample, 1.0);
                let seen = Innovation {
                    expected_variance: expected_variance
                        + wind_percent2 / (PERCENT_PER_MPS2 * PERCENT_PER_MPS2),
                    ..innovation
                };
                disagreeing = self.compare(seen, sample, context);
                if !self.is_trusted {
                    // The innovation is one beside errors that are forgotten now.
                    return None;
                }
            }
            // In low gears the torque that turns the engine is known worse.
            if !self.test.disagrees() && motion.variance < own_variance {
                self.learn(context, sample, regressors, innovation, state);
            }
        }
        if self.test.disagrees() {
            disagreeing = disagreeing.or(Some(1));
            self.doubted_m += sample.length_m;
            if self.doubted_m > context.tuning.inertial.longest_m {
                // Either may be wrong. Without it, the estimate is what it is on other vehicles.
                self.reject(context);
            }
        } else {
            // A wrong accelerometer may agree in between.
            self.doubted_m = Scalar::max(0.0, self.doubted_m - sample.length_m);
        }
        self.stand_in(context, sample, &motion, prediction, measured, own_variance);
        disagreeing
    }

    /// Returns the variance of the noise of a measurement, (m/s²)².
    fn own_variance(&self, measured: &InertialMeasurement, tuning: &Inertial) -> f32 {
        let (sigma, step) = (tuning.acceleration_sigma_mps2, measured.resolution_mps2);
        self.noise.ratio() * sigma * sigma / f32::from(measured.count.max(1)) + step * step / 12.0
    }

    /// Combines the prediction with the measurement, if its errors are known well enough.
    fn stand_in<S: Scalar>(
        &mut self,
        context: &Context,
        sample: &Sample,
        motion: &ModelMotion,
        prediction: &mut Prediction<S>,
        measured: &InertialMeasurement,
        own_variance: f32,
    ) {
        let tuning = &context.tuning.inertial;
        let (gain, change_gain) = self.errors.gains();
        let forces = forces_per_mass(context, sample, motion);
        let (offset_mps2, _) = self.errors.expected(Regressors::new(0.0, 0.0, forces));
        let acceleration_mps2 = measured.acceleration_mps2 - offset_mps2;
        let felt_mps2 = acceleration_mps2 / gain;
        let change_mps2 = felt_mps2 - motion.gravity_mps2;
        let (_, variance) = self
            .errors
            .expected(Regressors::new(felt_mps2, change_mps2, forces));
        // Each change of the source adds to what is not known.
        let most = if self.alone.is_on() { STAYS } else { 1.0 } * tuning.usable_sigma_mps2;
        if !self.is_trusted || variance > most * most {
            self.alone.end(variance, tuning);
            return;
        }
        // A traction that stands still is no better known than tractions change.
        let stale_percent = tuning.unchanged_percent_per_s * self.test.unusual_s();
        let suspected_mps2 = self.test.suspected_mps2() + stale_percent / PERCENT_PER_MPS2;
        prediction.add_force_noise(suspected_mps2, sample.length_m);
        let weight = prediction.combine(
            &MeasuredMotion {
                acceleration_mps2,
                per_change: change_gain,
                per_gravity: gain,
                variance: own_variance,
            },
            sample.length_m,
        );
        self.alone.follow(weight, variance, sample.length_m, tuning);
    }

    /// Returns the scale that it shows as a measurement, if there is a new one.
    #[inline]
    pub(super) fn weigh<S: Scalar>(
        &mut self,
        sample: &Sample,
        state: &State<S>,
        tuning: &Tuning,
    ) -> Option<ScalarMeasurement<S>> {
        if !self.is_trusted || sample.inertial.is_none() || self.test.disagrees() {
            return None;
        }
        self.weighing
            .next(self.errors.scale(), self.learned_m, state, &tuning.inertial)
    }

    /// Lets the errors walk over a cell: with the temperature of the sensor, and with the slow errors
    /// of the model, which are part of them.
    fn walk<S: Scalar>(&mut self, sample: &Sample, prediction: &Prediction<S>, tuning: &Tuning) {
        let drift = tuning.inertial.drift_mps2_per_sqrt_s;
        let of_model = prediction.slow_variance() / (PERCENT_PER_MPS2 * PERCENT_PER_MPS2);
        self.errors.walk(
            drift * drift * sample.duration_s + of_model,
            &tuning.inertial,
        );
    }

    /// Compares force and accelerometer. Returns the number of cells in which they disagree, if that
    /// is found now.
    fn compare(
        &mut self,
        innovation: Innovation,
        sample: &Sample,
        context: &mut Context,
    ) -> Option<u32> {
        let tuning = &context.tuning.inertial;
        match self.test.add(innovation, &mut self.errors, tuning) {
            Finding::Nothing => None,
            Finding::Disagrees { .. } if self.is_untested(tuning) => {
                self.reject(context);
                None
            }
            Finding::Disagrees { cells, error_mps2 } => {
                let length_m = cells as f32 * sample.length_m;
                self.alone.doubt(error_mps2, length_m, tuning);
                Some(cells)
            }
            Finding::AgreesAgain => {
                self.alone.believe();
                None
            }
        }
    }

    /// Learns from a cell in which the model holds.
    fn learn<S: Scalar>(
        &mut self,
        context: &mut Context,
        sample: &Sample,
        regressors: Regressors,
        innovation: Innovation,
        state: &State<S>,
    ) {
        let tuning = &context.tuning;
        let squared = innovation.mps2 * innovation.mps2;
        let variance = innovation.white_variance + innovation.expected_variance;
        let largest = tuning.measurement_noise.largest_innovation;
        if squared > largest * variance && self.is_trusted {
            return;
        }
        self.errors
            .update(regressors, innovation.mps2, innovation.white_variance);
        self.noise.learn(squared / variance, largest);
        self.learned_m += sample.length_m;
        let least_m = tuning.inertial.learned_m;
        if self.learned_m < least_m {
            return;
        }
        let (scale, scale_variance) = self.errors.total_scale();
        let known = state.covariance.variance(Scale).to_f32();
        let difference = scale - state.mean[Scale].to_f32();
        let of_sensor = tuning.inertial.scale_error;
        let most = scale_variance + known + of_sensor * of_sensor;
        if difference * difference > 9.0 * most || self.test.usual() > tuning.inertial.largest_usual
        {
            // Upside down, in another unit, or on another axis.
            self.reject(context);
            return;
        }
        let excited = tuning.inertial.known_scale_sigma;
        let (_, variance) = self.errors.expected(regressors);
        let sigma = tuning.inertial.known_sigma_mps2;
        self.is_trusted |= scale_variance < excited * excited && variance < sigma * sigma;
    }

    /// Stops using it until it has been learned anew.
    fn reject(&mut self, context: &mut Context) {
        if self.is_known() {
            count(&mut context.counters.accelerometers_rejected);
        }
        self.alone
            .end(self.offset_variance(), &context.tuning.inertial);
        self.alone.believe();
        *self = Self {
            reading: self.reading,
            alone: self.alone,
            ..Self::new(&context.tuning)
        };
    }
}

/// Returns the forces of the model in a cell, per mass.
fn forces_per_mass(context: &Context, sample: &Sample, motion: &ModelMotion) -> ForcesPerMass {
    let air_n = context
        .model
        .vehicle
        .drag_n(&sample.forces, sample.end.speed_mps);
    ForcesPerMass {
        net_traction_percent: motion.net_traction_percent,
        air_mps2: GRAVITY * air_n / sample.forces.weight_n(),
    }
}
