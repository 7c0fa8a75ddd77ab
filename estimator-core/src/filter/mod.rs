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
//! | [`step_record`] | what a step leaves for the smoother |

mod altitude_delay;
mod altitude_gate;
mod altitude_update;
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
mod noise_ratio;
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
pub mod step_record;
mod stuck_torque;

pub use altitude_gate::AltitudeEvent;
pub use covariance::Covariance;
pub use effect_uncertainty::EffectContribution;
pub use gross_mass::ModelMass;
pub use noise_ratio::SensorNoiseRatios;
pub use prior::SlowStates;
pub use quantity::{Quantity, QuantityEstimate};
pub use state::State;
pub use state_index::{STATES, StateIndex, StateVector};
pub use step_record::{Reset, SmootherInput, StepRecord};

use crate::cell::CellEnd;
use crate::context::Context;
use crate::counters::count;
use crate::sample::{Sample, SpeedMeasurement};
use crate::scalar::Scalar;
use crate::tuning::{Prior, Tuning};
use crate::vehicle::Traction;
use altitude_update::AltitudeUpdate;
use effect_uncertainty::EffectUncertainty;
use error_levels::{ErrorLevels, LevelCell, SlowVariances};
use gross_mass::possible_scale;
use inertial::Accelerometer;
use load_test::{LoadDecision, LoadTest, Opened};
use measurement::Observation;
use predict::Prediction;
use prior::{initial_state, reopen_bias, reopen_bias_and_scale};
use process_noise::{LearnedNoise, bias_variance, wind_variance};
use scale_bounds::{KeptScale, ScaleBounds};
use scale_prior_reset::ScalePriorReset;
use silent_brake::SilentBrake;
use slope_step::{allow_kink, allow_step};
use slope_update::SlopeUpdate;
use speed_update::SpeedUpdate;
use stuck_torque::StuckTorque;

/// The filter: a state that samples move.
#[derive(Clone, Debug)]
pub struct Filter<S> {
    state: Option<State<S>>,
    prior: Option<SlowStates>,
    speed: SpeedUpdate,
    altitude: AltitudeUpdate,
    slope: SlopeUpdate,
    effects: EffectUncertainty,
    scale_reset: ScalePriorReset,
    scale_bounds: ScaleBounds,
    levels: ErrorLevels,
    load: LoadTest,
    brake: SilentBrake,
    torque: StuckTorque,
    accelerometer: Accelerometer,
    /// Distance over which the model does not hold, up to the last cell, m.
    invalid_m: f32,
}

/// A state at the end of a cell before its measurements.
struct Predicted<'a, S> {
    state: &'a mut State<S>,
    /// Kinetic energy at the start of the cell, m²/s².
    energy_before: S,
    reset: Reset,
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
            speed: SpeedUpdate::new(noise, tuning),
            altitude: AltitudeUpdate::new(noise, tuning),
            slope: SlopeUpdate::new(),
            effects: EffectUncertainty::new(),
            scale_reset: ScalePriorReset::new(),
            scale_bounds: ScaleBounds::default(),
            levels: ErrorLevels::new(),
            load: LoadTest::default(),
            brake: SilentBrake::default(),
            torque: StuckTorque::default(),
            accelerometer: Accelerometer::new(tuning),
            invalid_m: 0.0,
        }
    }

    /// Starts with the sensor noise and the slow states of an earlier drive, before the first sample.
    pub fn resume(&mut self, tuning: &Tuning, noise: &SensorNoiseRatios, slow: SlowStates) {
        self.state = None;
        self.prior = Some(slow);
        self.speed = SpeedUpdate::new(noise, tuning);
        self.altitude.resume(noise, tuning);
    }

    /// Returns a filter for a second pass over the same drive. It starts with the same slow states,
    /// but with the sensor noise and the scale's prior that this filter has learned since.
    #[must_use]
    pub fn second_pass<T: Scalar>(&self, tuning: &Tuning) -> Filter<T> {
        Filter {
            scale_reset: self.scale_reset.restarted(),
            scale_bounds: self.scale_bounds,
            levels: self.levels.restarted(),
            speed: self.speed.second_pass(&self.noise(), tuning),
            altitude: self.altitude.second_pass(&self.noise(), tuning),
            slope: self.slope.second_pass(),
            brake: self.brake.second_pass(),
            accelerometer: self.accelerometer.second_pass(tuning),
            ..Filter::new(tuning, &self.noise(), self.prior)
        }
    }

    /// Returns what has been learned of the sensors' noise.
    #[must_use]
    pub const fn noise(&self) -> SensorNoiseRatios {
        SensorNoiseRatios {
            speed: self.speed.noise_ratio(),
            altitude: self.altitude.noise_ratio(),
            gnss_error: self.altitude.gnss_error_ratio(),
        }
    }

    fn learned_noise(&self, prior: &Prior) -> LearnedNoise {
        let levels = self.levels.levels();
        LearnedNoise {
            levels,
            gnss_error_ratio: levels.gnss_error_ratio(self.altitude.gnss_error_ratio()),
            force_ratio: self.speed.force_ratio(),
            launches: self.load.is_launching(prior),
            changes_mislead: self.scale_bounds.changes_mislead(),
            load_factor: self.state.as_ref().map_or(1.0, |state| {
                possible_scale(1.0 + state.mean[StateIndex::Scale].to_f32())
            }),
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
        self.reopen(context, sample);
        let braked = self.brake.advance(context, sample, self.state.as_ref());
        let sample = braked.as_ref().unwrap_or(sample);
        let is_stuck = self.torque.advance(sample);
        let mut reported = sample.end.condition;
        reported.no_traction |= is_stuck;
        let is_doubted = is_stuck || self.accelerometer.doubts_force(sample);
        let doubted = is_doubted.then(|| without_traction(sample));
        let sample = doubted.as_ref().unwrap_or(sample);
        let is_first = self.state.is_none();
        let steps_count = context.model.vehicle.traction != Traction::Force;
        if self.speed.take_step()
            && steps_count
            && let Some(state) = &mut self.state
        {
            allow_step(state, &context.tuning.gates);
            self.altitude.model_changed();
            count(&mut context.counters.slope_steps);
        }
        if !sample.end.condition.is_valid() {
            self.invalid_m += sample.length_m;
        } else if core::mem::take(&mut self.invalid_m) > context.tuning.gates.drift_segment_m
            && !self.accelerometer.stood_in()
            && let Some(state) = &mut self.state
        {
            allow_kink(state, &context.tuning.gates);
            self.altitude.model_changed();
        }
        let effects = self.effects.advance(context, sample);
        let learned = self.learned_noise(&context.tuning.prior);
        let mut prediction =
            Prediction::new(context, sample, self.state.as_ref(), &learned, effects);
        if let Some(state) = &mut self.state {
            self.accelerometer.widen(state);
        }
        let disagreeing_force = self.accelerometer.advance(
            context,
            sample,
            reported,
            self.state.as_ref(),
            &mut prediction,
        );
        let Self {
            state: slot,
            prior,
            speed,
            altitude,
            slope,
            scale_reset,
            scale_bounds,
            levels,
            load,
            brake,
            torque,
            accelerometer,
            ..
        } = self;
        let Predicted {
            state,
            energy_before,
            reset,
        } = predict(slot, &prediction, prior, scale_reset, context, sample)?;
        if is_first && !mass_is_told(context, sample) {
            let opened = if sample.end.speed_mps < context.tuning.detection.coast_mps {
                Opened::Standing
            } else {
                Opened::Moving
            };
            load.open(state, opened, &context.tuning.prior);
        }
        let hidden_slope_percent = if brake.may_brake() {
            context.tuning.detection.silent_brake_slope_percent
        } else {
            0.0
        };
        altitude.advance(
            &context.tuning,
            sample,
            state,
            prediction.dynamics(),
            hidden_slope_percent,
        );
        let mut disagreement = sample.disagreement;
        let mut is_undone = false;
        let mut disagreeing_cells = u32::from(sample.disagreeing_cells);
        if let Some(cells) = disagreeing_force {
            disagreement.torque = true;
            disagreeing_cells = disagreeing_cells.max(cells);
        }
        if let Some(innovation) = altitude.innovation(&context.tuning, sample, state)
            && let Some(cells) = brake.fix(context, sample, state, innovation)
        {
            disagreement.brake = true;
            altitude.brake_found();
            disagreeing_cells = disagreeing_cells.max(cells);
        }
        let gated = altitude.gate(context, sample, torque.resting_cells(sample), state);
        if let Some(cells) = gated.disagreeing_cells(sample.end.cell) {
            is_undone = gated.undoes_error && disagreement.is_none();
            if matches!(gated.event, Some(AltitudeEvent::TorqueStuck { .. })) {
                torque.found();
                disagreement.torque = true;
            } else {
                disagreement.climb = true;
            }
            disagreeing_cells = disagreeing_cells.max(cells);
        }
        let reset = gated.reset(reset);
        if reset != Reset::None {
            levels.interrupt();
        }
        if reset.is_gap() {
            altitude.delay_mut().interrupt();
        }
        let cell = level_cell(sample, state);
        altitude.delay_mut().advance(cell.climb_m, cell.duration_s);
        brake.drive(state, cell.length_m, cell.climb_m);
        if levels.knot_is_full(&context.tuning.process_noise) {
            levels.close_knot(&slow_variances(context, sample, state, learned.load_factor));
        }
        levels.advance(
            &cell,
            &context.tuning.process_noise,
            &context.tuning.measurement_noise,
        );
        if let Some(fix) = &gated.accepted {
            let (altitude_m, variance) = fix.above_origin(state);
            levels.fix(altitude_m, variance);
        }
        let speed = speed.apply(context, sample, state, energy_before, reset);
        let second = match load.decide(state, sample, &context.tuning.prior) {
            Some(LoadDecision::Same(update)) => Some((Observation::Scale, update)),
            decision => {
                if decision.is_some() {
                    count(&mut context.counters.loads_changed);
                    reopen_bias(state, context, sample);
                    scale_reset.start(state, &context.tuning.prior);
                }
                let is_overdue = slope.take(sample);
                if let Some(fix) = gated.accepted.filter(|_| !is_overdue) {
                    let update = altitude.apply(context, sample, state, scale_reset, fix);
                    Some((Observation::Altitude, update))
                } else {
                    slope
                        .measurement(context, sample, state, energy_before)
                        .or_else(|| accelerometer.weigh(sample, state, &context.tuning))
                        .map(|measured| (measured.observation, measured.apply(state)))
                }
            }
        };
        let kept = scale_bounds.keep(state, &context.tuning.prior);
        if kept == KeptScale::Unknown {
            scale_reset.start(state, &context.tuning.prior);
            altitude.model_changed();
            count(&mut context.counters.scales_out_of_bounds);
        }
        if !check(state, context, sample) {
            *slot = None;
            return None;
        }
        Some(StepRecord {
            end: CellEnd {
                condition: reported,
                ..sample.end
            },
            smoother_input: SmootherInput {
                dynamics: *prediction.dynamics(),
                reset,
                speed,
                second,
                scale_set: kept != KeptScale::Within,
            },
            event: gated.event,
            disagreement,
            disagreeing_cells,
            is_undone,
        })
    }

    /// Widens bias and scale where the vehicle stood before the cell and its load may have changed.
    fn reopen(&mut self, context: &mut Context, sample: &Sample) {
        if let Some(state) = &mut self.state
            && sample.after_load_change
        {
            reopen_bias_and_scale(state, context, sample);
            self.accelerometer.open_scale(&context.tuning);
            self.scale_reset.start(state, &context.tuning.prior);
            count(&mut context.counters.loads_reopened);
        }
        if let Some(state) = &mut self.state
            && (sample.after_stop || (sample.after_load_change && !sample.mass_is_reported))
        {
            self.load
                .open(state, Opened::Standing, &context.tuning.prior);
            self.accelerometer.open_scale(&context.tuning);
            self.altitude.model_changed();
        }
    }
}

/// Predicts the state to the end of the cell in place: copies of a state cost more than its
/// prediction. At the first cell and behind a gap, the state starts from the speed; without one it
/// is `None`.
#[inline(always)]
fn predict<'a, S: Scalar>(
    slot: &'a mut Option<State<S>>,
    prediction: &Prediction<S>,
    prior: &Option<SlowStates>,
    scale_reset: &mut ScalePriorReset,
    context: &Context,
    sample: &Sample,
) -> Option<Predicted<'a, S>> {
    match (&mut *slot, sample.speed) {
        (Some(state), _) if sample.gap_cells == 0 => {
            let energy_before = state.mean[StateIndex::KineticEnergy];
            prediction.apply(state);
            Some(Predicted {
                state: slot.as_mut()?,
                energy_before,
                reset: Reset::None,
            })
        }
        (_, Some(speed)) => {
            let state = slot.get_or_insert_with(|| {
                let mut state = initial_state(prior.as_ref(), context, sample);
                let lacking = S::from_f32(scale_reset.added());
                state.covariance.add_variance(StateIndex::Scale, lacking);
                scale_reset.start(&state, &context.tuning.prior);
                state
            });
            start_after_gap(state, &context.tuning, speed);
            state.net_traction = prediction.dynamics().net_traction;
            Some(Predicted {
                energy_before: state.mean[StateIndex::KineticEnergy],
                state,
                reset: Reset::Gap,
            })
        }
        (_, None) => None,
    }
}

/// Starts the states that a gap ends from a speed. The slow states stay as they are.
fn start_after_gap<S: Scalar>(state: &mut State<S>, tuning: &Tuning, speed: SpeedMeasurement) {
    let square = |sigma: f32| S::from_f32(sigma * sigma);
    state.mean.clear_after_gap();
    state.covariance.clear_after_gap();
    state.origin_m = None;
    let mps = speed.mean_mps;
    state.mean[StateIndex::KineticEnergy] = S::from_f32(0.5 * mps * mps);
    // The speed itself follows as a measurement. What is set here only has to be wider.
    for (index, sigma) in [
        (StateIndex::KineticEnergy, Scalar::max(1.0, mps)),
        (StateIndex::Slope, tuning.prior.slope_sigma_percent),
        (StateIndex::SlopeRate, tuning.process_noise.slope_rate_sigma),
    ] {
        state.covariance.set(index, index, square(sigma));
    }
}

/// Returns the sample as one without a known traction.
#[inline(never)] // Rare.
fn without_traction(sample: &Sample) -> Sample {
    let mut doubted = *sample;
    doubted.end.condition.no_traction = true;
    doubted
}

/// Returns whether the bus reports the mass, or an adopted effect knows it.
fn mass_is_told(context: &Context, sample: &Sample) -> bool {
    sample.mass_is_reported || context.model.effects.mass_variance() > 0.0
}

fn level_cell<S: Scalar>(sample: &Sample, state: &State<S>) -> LevelCell {
    let slope = state.mean[StateIndex::Slope] + state.net_traction * state.mean[StateIndex::Scale];
    LevelCell {
        length_m: sample.length_m,
        duration_s: sample.duration_s,
        climb_m: 0.01 * sample.length_m * slope.to_f32(),
    }
}

#[inline(never)] // Once a knot.
fn slow_variances<S: Scalar>(
    context: &Context,
    sample: &Sample,
    state: &State<S>,
    load_factor: f32,
) -> SlowVariances {
    SlowVariances {
        bias_variance: bias_variance(context, sample, load_factor),
        wind_variance: wind_variance(context, sample, load_factor),
        known_bias_variance: state.covariance.variance(StateIndex::Bias).to_f32(),
    }
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
