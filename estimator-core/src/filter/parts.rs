//! What the filter keeps besides its state: the update of each sensor with what it has learned, and
//! the tests of the model.

use super::altitude_update::{AltitudeUpdate, Gated};
use super::body_sensor::BodySensors;
use super::effect_uncertainty::EffectUncertainty;
use super::error_levels::{ErrorLevels, LevelCell, SlowVariances};
use super::gross_mass::possible_scale;
use super::inertial::Accelerometer;
use super::load_test::{LoadDecision, LoadTest, Opened};
use super::measurement::{Observation, ScalarUpdate};
use super::noise_ratio::SensorNoiseRatios;
use super::predict::Prediction;
use super::prior::{
    SlowStates, initial_state, reopen_bias, reopen_bias_and_scale, start_after_gap,
};
use super::process_noise::{LearnedNoise, bias_variance, wind_variance};
use super::scale_bounds::{KeptScale, ScaleBounds};
use super::scale_prior_reset::ScalePriorReset;
use super::silent_brake::SilentBrake;
use super::slope_step::{allow_kink, allow_step};
use super::slope_update::SlopeUpdate;
use super::speed_update::{EnergyBefore, SpeedUpdate};
use super::state::State;
use super::state_index::StateIndex;
use super::step_disagreement::StepDisagreement;
use super::step_record::Reset;
use super::stuck_torque::StuckTorque;
use super::traction_timing::TractionTiming;
use crate::cell::Condition;
use crate::context::Context;
use crate::counters::count;
use crate::sample::Sample;
use crate::scalar::Scalar;
use crate::tuning::{Gates, Tuning};
use crate::vehicle::Traction;

/// A state at the end of a cell before its measurements.
pub(super) struct Predicted<'a, S> {
    pub state: &'a mut State<S>,
    pub energy_before: EnergyBefore<S>,
    pub reset: Reset,
}

/// What the filter keeps besides its state.
#[derive(Clone, Debug)]
pub(super) struct Parts {
    pub speed: SpeedUpdate,
    pub altitude: AltitudeUpdate,
    pub slope: SlopeUpdate,
    pub effects: EffectUncertainty,
    pub scale_reset: ScalePriorReset,
    pub scale_bounds: ScaleBounds,
    pub levels: ErrorLevels,
    pub load: LoadTest,
    pub brake: SilentBrake,
    pub torque: StuckTorque,
    pub timing: TractionTiming,
    pub accelerometer: Accelerometer,
    /// Distance over which the model does not hold, up to the last cell, m.
    invalid_m: f32,
}

impl Parts {
    /// Creates the parts before the first sample.
    #[inline(always)] // See Estimator::new_in().
    pub(super) fn new(tuning: &Tuning, noise: &SensorNoiseRatios) -> Self {
        Self {
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
            timing: TractionTiming::default(),
            accelerometer: Accelerometer::new(tuning),
            invalid_m: 0.0,
        }
    }

    /// Starts with what an earlier drive left of the sensors, before the first sample.
    pub(super) fn resume(
        &mut self,
        tuning: &Tuning,
        noise: &SensorNoiseRatios,
        sensors: &BodySensors,
    ) {
        self.speed = SpeedUpdate::new(noise, tuning);
        self.altitude.resume(noise, tuning);
        if let Some(kept) = &sensors.accelerometer {
            self.accelerometer.resume(kept, tuning);
        }
        if let Some(kept) = &sensors.pitch {
            self.slope.resume(kept, &tuning.prior);
        }
    }

    /// Returns those for a second pass over the same drive.
    pub(super) fn second_pass(&self, tuning: &Tuning) -> Self {
        let noise = self.noise();
        Self {
            scale_reset: self.scale_reset.restarted(),
            scale_bounds: self.scale_bounds,
            levels: self.levels.restarted(),
            speed: self.speed.second_pass(&noise, tuning),
            altitude: self.altitude.second_pass(&noise, tuning),
            slope: self.slope.second_pass(),
            brake: self.brake.second_pass(),
            timing: self.timing.second_pass(),
            accelerometer: self.accelerometer.second_pass(tuning),
            ..Self::new(tuning, &noise)
        }
    }

    /// Returns what a drive with this state leaves of the sensors on the body.
    pub(super) fn body_sensors<S: Scalar>(&self, state: &State<S>, tuning: &Tuning) -> BodySensors {
        BodySensors {
            accelerometer: self.accelerometer.kept(state, tuning),
            pitch: self.slope.kept(state),
        }
    }

    /// Returns what has been learned of the sensors' noise.
    pub(super) const fn noise(&self) -> SensorNoiseRatios {
        SensorNoiseRatios {
            speed: self.speed.noise_ratio(),
            altitude: self.altitude.noise_ratio(),
            gnss_error: self.altitude.gnss_error_ratio(),
        }
    }

    /// Returns what has been learned of the noise of the process over the cell of a sample.
    pub(super) fn learned_noise<S: Scalar>(
        &mut self,
        context: &Context,
        sample: &Sample,
        state: Option<&State<S>>,
    ) -> LearnedNoise {
        let levels = self.levels.levels();
        LearnedNoise {
            levels,
            gnss_error_ratio: levels.gnss_error_ratio(self.altitude.gnss_error_ratio()),
            force_ratio: self.speed.force_ratio(),
            launches: self.load.is_launching(&context.tuning.prior),
            changes_mislead: self.scale_bounds.changes_mislead(),
            load_factor: state.map_or(1.0, |state| {
                possible_scale(1.0 + state.mean[StateIndex::Scale].to_f32())
            }),
            late_traction: self.timing.advance(context, sample, state),
        }
    }

    /// Widens bias and scale where the vehicle stood before the cell and its load may have changed.
    /// Returns the net traction that it lost there, %.
    pub(super) fn reopen<S: Scalar>(
        &mut self,
        state: &mut State<S>,
        context: &mut Context,
        sample: &Sample,
    ) -> S {
        if !(sample.after_stop || sample.after_load_change) {
            return S::ZERO;
        }
        let released = state.release_traction();
        let tuning = &context.tuning;
        if sample.after_load_change {
            reopen_bias_and_scale(state, context, sample);
            self.accelerometer.open_scale(tuning);
            self.scale_reset.start(state, &tuning.prior);
            count(&mut context.counters.loads_reopened);
        }
        if sample.after_stop || (sample.after_load_change && !sample.mass_is_reported) {
            let tuning = &context.tuning;
            self.load.open(state, Opened::Standing, &tuning.prior);
            self.accelerometer.open_scale(tuning);
            self.altitude.model_changed();
        }
        released
    }

    /// Compares the force with an accelerometer, and combines both. Returns the number of cells in
    /// which they are found to disagree.
    #[inline(always)] // A part of Filter::step().
    pub(super) fn measure_force<S: Scalar>(
        &mut self,
        context: &mut Context,
        sample: &Sample,
        reported: Condition,
        mut state: Option<&mut State<S>>,
        prediction: &mut Prediction<S>,
    ) -> Option<u32> {
        if let Some(state) = &mut state {
            self.accelerometer.widen(state);
        }
        self.accelerometer
            .advance(context, sample, reported, state.as_deref(), prediction)
    }

    /// Predicts the state to the end of the cell in place: copies of a state cost more than its
    /// prediction. At the first cell and behind a gap, the state starts from the speed; without one it
    /// is `None`.
    #[inline(always)] // A part of Filter::step().
    pub(super) fn predict<'a, S: Scalar>(
        &mut self,
        slot: &'a mut Option<State<S>>,
        prediction: &Prediction<S>,
        prior: Option<&SlowStates>,
        context: &Context,
        sample: &Sample,
    ) -> Option<Predicted<'a, S>> {
        if let Some(state) = slot
            && sample.gap_cells == 0
        {
            let energy_before = EnergyBefore::of(state);
            prediction.apply(state);
            return Some(Predicted {
                state: slot.as_mut()?,
                energy_before,
                reset: Reset::None,
            });
        }
        let speed = sample.speed?;
        let is_first = slot.is_none();
        let scale_reset = &mut self.scale_reset;
        let state = slot.get_or_insert_with(|| {
            let mut state = initial_state(prior, context, sample);
            let lacking = S::from_f32(scale_reset.added());
            state.covariance.add_variance(StateIndex::Scale, lacking);
            scale_reset.start(&state, &context.tuning.prior);
            state
        });
        start_after_gap(state, &context.tuning, speed);
        state.net_traction = prediction.dynamics().net_traction;
        let energy_before = EnergyBefore::of(state);
        if is_first {
            self.open_load(state, context, sample);
        }
        Some(Predicted {
            state,
            energy_before,
            reset: Reset::Gap,
        })
    }

    /// Opens the test of the load at the start of a drive, unless the bus or an effect gives the mass.
    fn open_load<S: Scalar>(&mut self, state: &mut State<S>, context: &Context, sample: &Sample) {
        if sample.mass_is_reported || context.model.effects.mass_variance() > 0.0 {
            return;
        }
        let opened = if sample.end.speed_mps < context.tuning.detection.coast_mps {
            Opened::Standing
        } else {
            Opened::Moving
        };
        self.load.open(state, opened, &context.tuning.prior);
        self.scale_reset.start_open(state);
    }

    /// Forgets the levels of the errors.
    pub(super) fn forget_error_levels(&mut self) {
        self.levels = ErrorLevels::new();
    }

    /// Allows for a step of the model's error.
    pub(super) fn allow_step<S: Scalar>(&mut self, state: &mut State<S>, gates: &Gates) {
        allow_step(state, gates);
        self.altitude.model_changed();
    }

    /// Allows for a slope that changes faster than roads do: speeds showed it in the last cell, or the
    /// model holds again after a distance without it.
    #[inline(always)] // A part of Filter::step().
    pub(super) fn allow_other_slope<S: Scalar>(
        &mut self,
        state: Option<&mut State<S>>,
        context: &mut Context,
        sample: &Sample,
    ) {
        let gates = &context.tuning.gates;
        let stepped = self.speed.take_step() && context.model.vehicle.traction != Traction::Force;
        let holds_again = if sample.end.condition.is_valid() {
            core::mem::take(&mut self.invalid_m) > gates.drift_segment_m
                && !self.accelerometer.stood_in()
        } else {
            self.invalid_m += sample.length_m;
            false
        };
        let Some(state) = state else { return };
        if stepped {
            allow_step(state, gates);
            count(&mut context.counters.slope_steps);
        }
        if holds_again {
            allow_kink(state, gates);
        }
        if stepped || holds_again {
            self.altitude.model_changed();
        }
    }

    /// Moves what follows the altitudes over the cell, and gates the altitude of the sample.
    #[inline(always)] // A part of Filter::step().
    pub(super) fn gate_altitude<S: Scalar>(
        &mut self,
        state: &mut State<S>,
        context: &mut Context,
        sample: &Sample,
        prediction: &Prediction<S>,
        disagreement: &mut StepDisagreement,
    ) -> Gated<S> {
        let hidden_slope_percent = if self.brake.may_brake() {
            context.tuning.detection.silent_brake_slope_percent
        } else {
            0.0
        };
        self.altitude.advance(
            &context.tuning,
            sample,
            state,
            prediction.dynamics(),
            hidden_slope_percent,
        );
        if let Some(innovation) = self.altitude.innovation(&context.tuning, sample, state)
            && let Some(cells) = self.brake.fix(context, sample, state, innovation)
        {
            disagreement.add_brake(cells);
            self.altitude.brake_found();
        }
        let resting_cells = self.torque.resting_cells(sample);
        let gated = self.altitude.gate(context, sample, resting_cells, state);
        state.doubt_variance = self.altitude.doubt_variance();
        if disagreement.add_altitude(&gated, sample.end.cell) {
            self.torque.found();
        }
        gated
    }

    /// Learns how large the errors of model and receiver are.
    #[inline(always)] // A part of Filter::step().
    pub(super) fn learn_levels<S: Scalar>(
        &mut self,
        state: &State<S>,
        context: &Context,
        sample: &Sample,
        gated: &Gated<S>,
        (reset, load_factor): (Reset, f32),
    ) {
        let Self {
            levels,
            altitude,
            brake,
            timing,
            ..
        } = self;
        if reset != Reset::None {
            levels.interrupt();
            timing.interrupt();
        }
        if reset.is_gap() {
            altitude.delay_mut().interrupt();
        }
        let cell = level_cell(sample, state);
        altitude.delay_mut().advance(cell.climb_m, cell.duration_s);
        brake.drive(state, cell.length_m, cell.climb_m);
        let tuning = &context.tuning;
        if levels.knot_is_full(&tuning.process_noise) {
            levels.close_knot(&slow_variances(context, sample, state, load_factor));
        }
        levels.advance(&cell, &tuning.process_noise, &tuning.measurement_noise);
        let fix = gated.accepted.as_ref().map(|fix| fix.above_origin(state));
        if let Some((altitude_m, variance)) = fix {
            levels.fix(altitude_m, variance);
        }
        let altitude_m = fix.map(|(altitude_m, _)| altitude_m);
        let memory = tuning.measurement_noise.delay_readings;
        timing.compare_climbs(sample, state, altitude_m, memory);
    }

    /// Updates the state with one measurement besides the speed: the load, the altitude, a slope or an
    /// acceleration, whichever is due.
    #[inline(always)] // A part of Filter::step().
    pub(super) fn update_besides_speed<S: Scalar>(
        &mut self,
        state: &mut State<S>,
        context: &mut Context,
        sample: &Sample,
        gated: &Gated<S>,
        energy_before: S,
    ) -> Option<(Observation, ScalarUpdate<S>)> {
        match self.load.decide(state, sample, &context.tuning.prior) {
            Some(LoadDecision::Same(update)) => return Some((Observation::Scale, update)),
            None => {}
            Some(_) => {
                count(&mut context.counters.loads_changed);
                reopen_bias(state, context, sample);
                self.scale_reset.start(state, &context.tuning.prior);
            }
        }
        let is_overdue = self.slope.take(sample);
        if let Some(fix) = gated.accepted.filter(|_| !is_overdue) {
            let reset = &mut self.scale_reset;
            let update = self.altitude.apply(context, sample, state, reset, fix);
            return Some((Observation::Altitude, update));
        }
        self.slope
            .measurement(context, sample, state, energy_before)
            .or_else(|| self.accelerometer.weigh(sample, state, &context.tuning))
            .map(|measured| (measured.observation, measured.apply(state)))
    }

    /// Keeps the scale within its bounds. Returns whether it is another one now.
    #[inline(always)] // A part of Filter::step().
    pub(super) fn keep_scale<S: Scalar>(
        &mut self,
        state: &mut State<S>,
        context: &mut Context,
    ) -> bool {
        let prior = &context.tuning.prior;
        let kept = self.scale_bounds.keep(state, prior);
        if kept == KeptScale::Unknown {
            self.scale_reset.start(state, prior);
            self.altitude.model_changed();
            count(&mut context.counters.scales_out_of_bounds);
        }
        kept != KeptScale::Within
    }
}

fn level_cell<S: Scalar>(sample: &Sample, state: &State<S>) -> LevelCell {
    LevelCell {
        length_m: sample.length_m,
        duration_s: sample.duration_s,
        climb_m: 0.01 * sample.length_m * state.slope_by_forces().to_f32(),
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
