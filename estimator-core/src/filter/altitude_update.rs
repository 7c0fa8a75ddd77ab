//! The update with the GNSS altitude: what the gate decides of it, and the measurement.

use super::altitude_delay::{AltitudeDelay, CellAltitude, Restored};
use super::altitude_gate::{
    AltitudeEvent, AltitudeGate, AltitudeInnovation, GateDecision, ModelError, Segment, TestedFix,
};
use super::dynamics::Dynamics;
use super::measurement::{Observation, ScalarMeasurement, ScalarUpdate};
use super::noise_ratio::SensorNoiseRatios;
use super::prior::reopen_bias_and_scale;
use super::process_noise::wind_variance;
use super::scale_prior_reset::ScalePriorReset;
use super::state::State;
use super::state_index::StateIndex::{Altitude, Bias, GnssError, Scale, Slope, Wind};
use super::step_record::Reset;
use crate::context::Context;
use crate::counters::{Counters, count};
use crate::sample::{AltitudeContinuity, AltitudeMeasurement, Sample};
use crate::scalar::Scalar;
use crate::tuning::Tuning;

/// What the filter remembers for the altitude updates.
#[derive(Clone, Debug)]
pub(super) struct AltitudeUpdate {
    gate: AltitudeGate,
    /// Steps of the receiver since the altitude was set from it, m.
    datum_m: f32,
    delay: AltitudeDelay,
    /// The altitude at the cell's end, if there is one.
    received: Option<ReceivedAltitude>,
}

/// An altitude as the receiver reports it, and as it was before the receiver smoothed it, at the
/// cell's end.
#[derive(Clone, Copy, Debug)]
struct ReceivedAltitude {
    reported: CellAltitude,
    restored: Option<Restored>,
}

/// A GNSS altitude at the cell's end.
#[derive(Clone, Copy, Debug)]
struct Fix<S> {
    altitude_m: f32,
    variance: S,
    continuity: AltitudeContinuity,
}

/// Error of the slope, in sigmas, from which on the cells are marked in which it was made.
const WRONG_SIGMAS: f32 = 2.0;

/// A fix that passed the gate.
#[derive(Clone, Copy, Debug)]
pub(super) struct AcceptedFix<S>(Fix<S>);

/// What the gate left of an altitude.
#[derive(Clone, Copy, Debug)]
pub(super) struct Gated<S> {
    /// The fix with which to update the state, if any.
    pub accepted: Option<AcceptedFix<S>>,
    /// What happened besides.
    pub event: Option<AltitudeEvent>,
    /// Whether the altitude was set from the fix.
    pub sets_altitude: bool,
    /// Whether what the altitudes taught since a drift began is undone, and was wrong by more than
    /// its sigma says.
    pub undoes_error: bool,
}

impl AltitudeUpdate {
    /// Creates the memory with the noise known so far.
    #[inline(always)] // See Estimator::new_in().
    pub(super) fn new(noise: &SensorNoiseRatios, tuning: &Tuning) -> Self {
        Self {
            gate: AltitudeGate::new(noise, tuning),
            datum_m: 0.0,
            delay: AltitudeDelay::new(),
            received: None,
        }
    }

    /// Starts with the noise known from an earlier drive, before the first sample.
    pub(super) fn resume(&mut self, noise: &SensorNoiseRatios, tuning: &Tuning) {
        self.gate.start_with(noise, tuning);
    }

    /// Returns the memory for a second pass over the same drive.
    pub(super) fn second_pass(&self, noise: &SensorNoiseRatios, tuning: &Tuning) -> Self {
        Self {
            delay: self.delay.restarted(&tuning.measurement_noise),
            ..Self::new(noise, tuning)
        }
    }

    /// Returns the delay of the altitudes.
    pub(super) const fn delay_mut(&mut self) -> &mut AltitudeDelay {
        &mut self.delay
    }

    /// Notes that the model's error is another one from here on.
    pub(super) fn model_changed(&mut self) {
        self.gate.restart_climb_test();
    }

    /// Returns learned over assumed variance of a single fix.
    pub(super) const fn noise_ratio(&self) -> f32 {
        self.gate.noise_ratio()
    }

    /// Returns learned over assumed variance of the coloured error.
    pub(super) const fn gnss_error_ratio(&self) -> f32 {
        self.gate.gnss_error_ratio()
    }

    /// Returns the variance of the grade by which climbs differ beyond what the states say, %².
    pub(super) const fn doubt_variance(&self) -> f32 {
        self.gate.doubt_variance()
    }

    /// Notes that a brake was found: what looked like a drift was a descent.
    pub(super) fn brake_found(&mut self) {
        self.gate.restart();
    }

    /// Advances over a cell whose end was predicted. `hidden_slope_percent` is what a brake may
    /// hide over it.
    #[inline]
    pub(super) fn advance<S: Scalar>(
        &mut self,
        tuning: &Tuning,
        sample: &Sample,
        state: &State<S>,
        dynamics: &Dynamics<S>,
        hidden_slope_percent: f32,
    ) {
        self.delay.work(&tuning.measurement_noise);
        let segment = Segment {
            hidden_descent_m: 0.01 * hidden_slope_percent * sample.length_m,
            ..segment(state, dynamics, sample)
        };
        self.gate.advance(segment, sample.duration_s);
        self.received = sample.altitude.as_ref().map(|altitude| {
            let forces_per_m = 0.01 * state.slope_by_forces().to_f32();
            let road_per_m = forces_per_m - 0.01 * (state.mean[Bias] + state.mean[Wind]).to_f32();
            let from_start_m = sample.length_m - altitude.behind_m;
            let reported = CellAltitude {
                altitude_m: altitude.altitude_m,
                climb_m: from_start_m * forces_per_m,
                duration_s: from_start_m * sample.duration_s / sample.length_m,
            };
            let restored = self.delay.restored(&reported).map(|restored| Restored {
                altitude_m: restored.altitude_m + altitude.behind_m * road_per_m,
                ..restored
            });
            ReceivedAltitude { reported, restored }
        });
    }

    /// Returns the altitude of a sample, its innovation, m, and its variance; `None` without an
    /// altitude, or where it does not follow from what was before.
    #[inline]
    pub(super) fn innovation<S: Scalar>(
        &self,
        tuning: &Tuning,
        sample: &Sample,
        state: &State<S>,
    ) -> Option<(f32, f32, f32)> {
        let altitude = sample.altitude.as_ref()?;
        if state.origin_m.is_none()
            || altitude.continuity != AltitudeContinuity::Followed
            || self.delay.has_changed()
        {
            return None;
        }
        let fix = self.fix(tuning, altitude)?;
        Some((
            fix.altitude_m,
            fix.innovation(state).to_f32(),
            fix.innovation_variance(state).to_f32(),
        ))
    }

    /// Passes the altitude of a sample through the gate, and applies what the gate decides besides
    /// the update: the altitude set, the datum moved, a drift undone.
    #[inline]
    pub(super) fn gate<S: Scalar>(
        &mut self,
        context: &mut Context,
        sample: &Sample,
        resting_cells: u32,
        state: &mut State<S>,
    ) -> Gated<S> {
        let Some(altitude) = &sample.altitude else {
            return Gated::NONE;
        };
        let Some(ReceivedAltitude { reported, .. }) = self.received else {
            return Gated::NONE;
        };
        let Some(mut fix) = self.fix(&context.tuning, altitude) else {
            // It shows how fast altitudes change, and the next one can be restored.
            self.delay.fix(&reported);
            return Gated::NONE;
        };
        let delay_changed = self.delay.take_change();
        if delay_changed {
            // What altitudes taught so far was of another place.
            self.gate.unlearn(&context.tuning);
            reopen_bias_and_scale(state, context, sample);
        }
        if self.gate.silent_s() > context.tuning.gates.altitude_gap_s {
            count(&mut context.counters.altitude_gaps);
        }
        let (decision, event) =
            self.decide(context, sample, resting_cells, state, &fix, delay_changed);
        let mut gated = Gated {
            event,
            ..Gated::NONE
        };
        match decision {
            GateDecision::Fuse => {
                self.delay.fix(&reported);
                gated.accepted = Some(AcceptedFix(fix));
            }
            GateDecision::MoveDatum => {
                self.move_datum(state, &mut fix);
                gated.accepted = Some(AcceptedFix(fix));
            }
            GateDecision::SetAltitude => {
                self.set_altitude(state, &mut fix);
                gated.sets_altitude = true;
            }
            GateDecision::SetAltitudeAndUndo(model_error, sigma_percent) => {
                undo_drift(state, &model_error);
                let variance = S::from_f32(sigma_percent * sigma_percent);
                state.covariance.add_variance(Slope, variance);
                self.set_altitude(state, &mut fix);
                gated.sets_altitude = true;
            }
            GateDecision::SetAltitudeAndWiden(index, sigma_percent) => {
                let variance = S::from_f32(sigma_percent * sigma_percent);
                state.covariance.add_variance(index, variance);
                self.set_altitude(state, &mut fix);
                gated.sets_altitude = true;
            }
            GateDecision::Reject => context.counters.altitudes_rejected += 1,
            GateDecision::RejectAndUndo(model_error, slope_percent) => {
                let sigma = state.sigma(Slope).to_f32();
                let undone_percent = undo_drift(state, &model_error);
                gated.undoes_error = undone_percent.abs() > WRONG_SIGMAS * sigma;
                // Receiver or model: which of them is off, the fixes that follow show. Only a receiver
                // is off by more than resistances are.
                let most = context.tuning.gates.drift_model_most_percent;
                let sigma = S::from_f32(Scalar::min(most, slope_percent.abs()));
                state.covariance.add_variance(Bias, sigma * sigma);
                context.counters.altitudes_rejected += 1;
            }
        }
        if let Some(event) = event {
            count_event(&mut context.counters, event);
        }
        gated
    }

    /// Updates the state with a fix that passed the gate.
    #[inline]
    pub(super) fn apply<S: Scalar>(
        &mut self,
        context: &mut Context,
        sample: &Sample,
        state: &mut State<S>,
        scale_reset: &mut ScalePriorReset,
        AcceptedFix(fix): AcceptedFix<S>,
    ) -> ScalarUpdate<S> {
        let measurement = ScalarMeasurement {
            observation: Observation::Altitude,
            innovation: fix.innovation(state),
            variance: fix.variance,
        };
        context.counters.altitudes_used += 1;
        let update = measurement.apply(state);
        if scale_reset.widen(state, sample.end.cell, &context.tuning.prior) {
            // The model's error passed for noise of the receiver.
            self.gate.unlearn(&context.tuning);
            count(&mut context.counters.scales_reopened);
        }
        update
    }

    /// Returns the fix at the cell's end, with the variance of its white noise.
    fn fix<S: Scalar>(&self, tuning: &Tuning, altitude: &AltitudeMeasurement) -> Option<Fix<S>> {
        let sigma = tuning.measurement_noise.altitude_sigma_m * altitude.dilution;
        let restored = self.received?.restored?;
        Some(Fix {
            altitude_m: restored.altitude_m - self.datum_m,
            variance: S::from_f32(self.gate.noise_ratio() * sigma * sigma + restored.variance),
            continuity: altitude.continuity,
        })
    }

    /// Decides what to do with a fix, given the state before the measurements.
    fn decide<S: Scalar>(
        &mut self,
        context: &Context,
        sample: &Sample,
        resting_cells: u32,
        state: &State<S>,
        fix: &Fix<S>,
        delay_changed: bool,
    ) -> (GateDecision, Option<AltitudeEvent>) {
        let tuning = &context.tuning;
        if state.origin_m.is_none()
            || delay_changed
            || fix.continuity == AltitudeContinuity::Switched
            || self.gate.silent_s() >= tuning.gates.gnss_silence.seconds()
        {
            self.gate.restart();
            return (GateDecision::SetAltitude, Some(AltitudeEvent::SetAnew));
        }
        if fix.continuity == AltitudeContinuity::Drifted {
            self.gate.restart();
            return (GateDecision::MoveDatum, None);
        }
        let gnss_error_sigma_m = tuning.measurement_noise.gnss_error_sigma_m;
        let innovation = AltitudeInnovation {
            innovation: fix.innovation(state),
            variance: fix.innovation_variance(state),
            cell: sample.end.cell,
            fix: TestedFix {
                altitude_m: fix.altitude_m,
                variance: fix.variance.to_f32(),
                gnss_error_variance: self.gate.gnss_error_ratio()
                    * gnss_error_sigma_m
                    * gnss_error_sigma_m,
                wind_variance: wind_variance(context, sample, 1.0),
                per_wind_length: 1.0 / tuning.process_noise.wind_length_m,
            },
            resting_cells,
        };
        self.gate.decide(&innovation, state, tuning)
    }

    /// Moves the receiver's datum so that a fix has no innovation. How far is as uncertain as the
    /// innovation was.
    fn move_datum<S: Scalar>(&mut self, state: &mut State<S>, fix: &mut Fix<S>) {
        let step_m = fix.innovation(state).to_f32();
        let variance = fix.innovation_variance(state);
        fix.altitude_m -= step_m;
        self.datum_m += step_m;
        state.covariance.add_variance(GnssError, variance);
    }

    /// Sets the altitude to the fix less the GNSS error, so that the two share the fix's error.
    #[inline(never)] // Rare, and called from several places.
    fn set_altitude<S: Scalar>(&mut self, state: &mut State<S>, fix: &mut Fix<S>) {
        fix.altitude_m += self.datum_m;
        self.datum_m = 0.0;
        let origin_m = *state.origin_m.get_or_insert(fix.altitude_m);
        let above_origin = S::from_f32(fix.altitude_m - origin_m);
        state.mean[Altitude] = above_origin - state.mean[GnssError];
        state.covariance.clear(Altitude);
        state.covariance.shear(Altitude, GnssError, -S::ONE);
        state.covariance.add_variance(Altitude, fix.variance);
    }
}

impl<S: Scalar> AcceptedFix<S> {
    /// Returns the altitude above the origin, m, and the variance of its white noise, m².
    pub(super) fn above_origin(&self, state: &State<S>) -> (f32, f32) {
        let Self(fix) = self;
        let origin_m = state.origin_m.unwrap_or(fix.altitude_m);
        (fix.altitude_m - origin_m, fix.variance.to_f32())
    }
}

impl<S: Scalar> Gated<S> {
    /// Without an altitude.
    const NONE: Self = Self {
        accepted: None,
        event: None,
        sets_altitude: false,
        undoes_error: false,
    };

    /// Returns the number of cells up to this one whose estimates came from altitudes, or a model,
    /// that are found to be wrong. What comes after a drift began is not among them: its altitudes
    /// are left out, and the model is as uncertain as it then may be.
    pub(super) const fn disagreeing_cells(&self, cell: u32) -> Option<u32> {
        match self.event {
            Some(AltitudeEvent::DriftBegan(since)) if self.undoes_error => {
                Some(cell.saturating_sub(since) + 1)
            }
            Some(AltitudeEvent::Contradicted { cells } | AltitudeEvent::TorqueStuck { cells }) => {
                Some(cells)
            }
            _ => None,
        }
    }

    /// Returns the reset of the step with what the gate did.
    pub(super) const fn reset(&self, before: Reset) -> Reset {
        if self.sets_altitude {
            before.and_altitude()
        } else {
            before
        }
    }
}

impl<S: Scalar> Fix<S> {
    fn innovation(&self, state: &State<S>) -> S {
        let origin_m = state.origin_m.unwrap_or(self.altitude_m);
        S::from_f32(self.altitude_m - origin_m)
            - Observation::Altitude.of(&state.mean, state.net_traction)
    }

    fn innovation_variance(&self, state: &State<S>) -> S {
        let observation = Observation::Altitude;
        let net_traction = state.net_traction;
        let cross = observation.cross(&state.covariance, net_traction);
        observation.of(&cross, net_traction) + self.variance
    }
}

/// Returns what the model reads over the cell of a sample.
fn segment<S: Scalar>(state: &State<S>, dynamics: &Dynamics<S>, sample: &Sample) -> Segment {
    let per_percent_m = 0.01 * sample.length_m;
    Segment {
        length_m: sample.length_m,
        gnss_error_kept: dynamics.keep_gnss_error.to_f32(),
        climb_m: per_percent_m * state.mean[Slope].to_f32(),
        traction_climb_m: per_percent_m * state.net_traction.to_f32(),
        invalid_sigma_m: if sample.end.condition.is_valid() {
            0.0
        } else {
            per_percent_m * state.sigma(Slope).to_f32()
        },
        hidden_descent_m: 0.0,
    }
}

/// Returns to the model error that was known before a drift. What the drift moved it by becomes
/// variance. Returns by how much the slope was off, %.
#[inline(never)] // Rare.
fn undo_drift<S: Scalar>(state: &mut State<S>, known: &ModelError) -> f32 {
    let slope = |state: &State<S>| Observation::RoadSlope.of(&state.mean, state.net_traction);
    let wrong = slope(state);
    for (index, before) in [
        (Bias, known.bias_percent),
        (Wind, known.wind_percent),
        (Scale, known.scale),
    ] {
        let before = S::from_f32(before);
        let moved = state.mean[index] - before;
        state.mean[index] = before;
        state.covariance.add_variance(index, moved * moved);
    }
    (slope(state) - wrong).to_f32()
}

fn count_event(counters: &mut Counters, event: AltitudeEvent) {
    count(match event {
        AltitudeEvent::Outlier => &mut counters.altitude_outliers,
        AltitudeEvent::Stepped(_) => &mut counters.altitude_steps,
        AltitudeEvent::DriftBegan(_) => &mut counters.altitude_drifts,
        AltitudeEvent::DriftEnded(_) => return,
        AltitudeEvent::DriftBelieved => &mut counters.altitude_drifts_believed,
        AltitudeEvent::SetAnew => &mut counters.altitude_resets,
        AltitudeEvent::Contradicted { .. } | AltitudeEvent::TorqueStuck { .. } => {
            &mut counters.climbs_contradicted
        }
    });
}
