//! The grade Kalman filter: a linear filter in the distance domain.
//!
//! One step is one cell. With e = v²/2 as the speed state and the sine of the slope angle as the
//! grade state, the force balance (thesis eq. 9), the climb and every measurement are linear. No
//! Jacobian is approximated, and nothing divides by a small speed. F is a few shears, each
//! measurement a scalar.
//!
//! | file | content |
//! |---|---|
//! | `state_index`, [`state`], [`covariance`] | the states; their mean and covariance |
//! | [`quantity`] | what is linear in the states: slope of the road, altitude, bias, scale |
//! | [`dynamics`], `process_noise`, [`predict`] | F, Q, and the prediction with them |
//! | [`measurement`], `speed_update`, `altitude_update`, `slope_update` | h and the scalar update; R of each sensor |
//! | `altitude_gate` | which altitudes to use; the climb test |
//! | `altitude_delay`, `low_pass_bank` | receivers that smooth their altitudes |
//! | `noise_ratio` | measurement noise learned from innovations |
//! | `inertial` | the accelerometer as a second measurement of the force |
//! | `effect_uncertainty` | force and uncertainty of the adopted effects |
//! | [`gross_mass`] | the mass that follows from the scale |
//! | [`prior`], `scale_prior_reset` | what is assumed where a drive begins, and when that was wrong |
//! | [`body_sensor`] | what a drive leaves of accelerometer and pitch sensor |
//! | `net_traction`, `traction_timing`, `climb_lag` | net traction of a cell; a force that is late, and how late |
//! | `parts` | what the filter keeps besides its state, and the stages of a step |
//! | [`step_record`], `step_disagreement` | what a step leaves for the smoother; what disagrees in it |

mod altitude_delay;
mod altitude_gate;
mod altitude_update;
pub mod body_sensor;
mod climb_lag;
pub mod covariance;
pub mod dynamics;
mod effect_uncertainty;
mod error_levels;
mod gauss_markov;
pub mod gross_mass;
mod inertial;
mod load_test;
mod low_pass_bank;
pub mod measurement;
mod net_traction;
mod noise_ratio;
mod parts;
pub mod predict;
pub mod prior;
mod process_noise;
pub mod quantity;
mod scale_bounds;
mod scale_prior_reset;
mod silent_brake;
mod slope_step;
mod slope_update;
mod speed_update;
pub mod state;
pub mod state_index;
mod step_disagreement;
pub mod step_record;
mod stuck_torque;
mod traction_timing;

pub use altitude_gate::AltitudeEvent;
pub use body_sensor::{BodySensor, BodySensors};
pub use covariance::Covariance;
pub use effect_uncertainty::{EffectContribution, EffectUncertainty};
pub use gross_mass::ModelMass;
pub use noise_ratio::SensorNoiseRatios;
pub(crate) use noise_ratio::{learned_sigma, variance_ratio};
pub use prior::SlowStates;
pub use quantity::{Quantity, QuantityEstimate};
pub use state::State;
pub use state_index::{STATES, StateIndex, StateVector};
pub use step_record::{Reset, SmootherInput, StepRecord};

use crate::cell::CellEnd;
use crate::context::Context;
use crate::counters::count;
use crate::sample::Sample;
use crate::scalar::Scalar;
use crate::tuning::Tuning;
use parts::{Parts, Predicted};
use predict::Prediction;
use step_disagreement::StepDisagreement;

/// The filter: a state that samples move.
#[derive(Clone, Debug)]
pub struct Filter<S> {
    state: Option<State<S>>,
    prior: Option<SlowStates>,
    parts: Parts,
}

impl<S: Scalar> Filter<S> {
    /// Creates a filter before its first sample, with the sensor noise known so far and, from an
    /// earlier drive, the slow states.
    #[must_use]
    #[inline(always)] // See Estimator::new_in().
    pub fn new(tuning: &Tuning, noise: &SensorNoiseRatios, prior: Option<SlowStates>) -> Self {
        Self {
            state: None,
            prior,
            parts: Parts::new(tuning, noise),
        }
    }

    /// Starts with the sensor noise, the slow states and the sensors on the body of an earlier drive,
    /// before the first sample.
    pub fn resume(
        &mut self,
        tuning: &Tuning,
        noise: &SensorNoiseRatios,
        slow: SlowStates,
        sensors: &BodySensors,
    ) {
        self.state = None;
        self.prior = Some(slow);
        self.parts.resume(tuning, noise, sensors);
    }

    /// Returns a filter for a second pass over the same drive. It starts with the same slow states,
    /// but with the sensor noise and the scale's prior that this filter has learned since.
    #[must_use]
    pub fn second_pass<T: Scalar>(&self, tuning: &Tuning) -> Filter<T> {
        Filter {
            state: None,
            prior: self.prior,
            parts: self.parts.second_pass(tuning),
        }
    }

    /// Returns what has been learned of the sensors' noise.
    #[must_use]
    pub const fn noise(&self) -> SensorNoiseRatios {
        self.parts.noise()
    }

    /// Returns what has been learned of the sensors on the body; none before the first speed.
    #[must_use]
    pub fn body_sensors(&self, tuning: &Tuning) -> BodySensors {
        self.state
            .as_ref()
            .map_or_else(BodySensors::default, |state| {
                self.parts.body_sensors(state, tuning)
            })
    }

    /// Forgets how large the errors of model and receiver were found to be.
    pub fn forget_error_levels(&mut self) {
        self.parts.forget_error_levels();
    }

    /// Allows for a step of the model's error at the end of the last cell, as
    /// [`BackwardPass::bias_step`](crate::smoother::BackwardPass::bias_step) finds it.
    pub fn allow_step(&mut self, tuning: &Tuning) {
        if let Some(state) = &mut self.state {
            self.parts.allow_step(state, &tuning.gates);
        }
    }

    /// Returns the state; `None` before the first speed.
    #[must_use]
    pub const fn state(&self) -> Option<&State<S>> {
        self.state.as_ref()
    }

    /// Moves the filter over the cell of a sample: predicts, gates the altitude, updates with speed
    /// and altitude, and checks the result.
    ///
    /// Returns the record for the smoother. It is `None` before the first speed, and after a
    /// non-finite result, which restarts the filter and is counted.
    pub fn step(&mut self, context: &mut Context, sample: &Sample) -> Option<StepRecord<S>> {
        let Self {
            state,
            prior,
            parts,
        } = self;
        let released = state
            .as_mut()
            .map_or(S::ZERO, |state| parts.reopen(state, context, sample));
        let braked = parts.brake.advance(context, sample, state.as_ref());
        let sample = braked.as_ref().unwrap_or(sample);
        let is_stuck = parts.torque.advance(sample);
        let mut reported = sample.end.condition;
        reported.no_traction |= is_stuck;
        let is_doubted = is_stuck || parts.accelerometer.doubts_force(sample);
        let doubted = is_doubted.then(|| without_traction(sample));
        let sample = doubted.as_ref().unwrap_or(sample);
        parts.allow_other_slope(state.as_mut(), context, sample);

        let effects = parts.effects.advance(context, sample);
        let learned = parts.learned_noise(context, sample, state.as_ref());
        let mut prediction = Prediction::new(context, sample, state.as_ref(), &learned, effects);
        let disagreeing_force =
            parts.measure_force(context, sample, reported, state.as_mut(), &mut prediction);
        let mut disagreement = StepDisagreement::of(sample, disagreeing_force);
        let Predicted {
            state: at_end,
            energy_before,
            reset,
        } = parts.predict(state, &prediction, prior.as_ref(), context, sample)?;

        let gated = parts.gate_altitude(at_end, context, sample, &prediction, &mut disagreement);
        let reset = gated.reset(reset);
        let load_factor = learned.load_factor;
        parts.learn_levels(at_end, context, sample, &gated, (reset, load_factor));
        let speed = parts
            .speed
            .apply(context, sample, at_end, energy_before, reset);
        let second =
            parts.update_besides_speed(at_end, context, sample, &gated, energy_before.mean);
        let scale_set = parts.keep_scale(at_end, context);
        if !check(at_end, context, sample) {
            *state = None;
            return None;
        }
        Some(StepRecord {
            end: CellEnd {
                condition: reported,
                ..sample.end
            },
            smoother_input: SmootherInput {
                dynamics: prediction.dynamics().after_release(released),
                reset,
                speed,
                second,
                scale_set,
            },
            event: gated.event,
            disagreement: disagreement.kinds,
            disagreeing_cells: disagreement.cells,
            is_undone: disagreement.is_undone,
        })
    }
}

/// Returns the sample as one without a known traction.
#[inline(never)] // Rare.
fn without_traction(sample: &Sample) -> Sample {
    let mut doubted = *sample;
    doubted.end.condition.no_traction = true;
    doubted
}

/// Counts the step, and returns whether its result is finite. It is for finite input; otherwise the
/// next speed restarts the filter.
fn check<S: Scalar>(state: &State<S>, context: &mut Context, sample: &Sample) -> bool {
    let counters = &mut context.counters;
    counters.steps += 1;
    if !sample.end.condition.is_valid() {
        counters.invalid_steps += 1;
    }
    let is_sound = state.is_sound();
    if !is_sound {
        count(&mut counters.restarts);
    }
    is_sound
}
