//! The altitude gate: which GNSS altitudes to use.
//!
//! * A fix whose innovation is beyond what its variance allows is rejected. A single one is an
//!   outlier. Several in a row with about the same offset are a step of the receiver (other
//!   satellites, a street canyon): its datum moves by that offset, and the variance of the GNSS
//!   error grows. Altitude, slope, bias and scale stay what they were.
//! * Fixes that climb unlike the vehicle model over hundreds of metres drift. They are rejected
//!   until they climb with the model again, and what they moved of bias, wind and scale is undone.
//!   If they never do, the model is off, and they are used again.
//! * After a change of the source, or a long silence, the next fix sets the altitude, and only that.
//!
//! The noise of single fixes and the size of the coloured error are learned: receivers differ by a
//! factor of ten in both. A gate that takes a noisy receiver for a good one would select the fixes
//! that agree with it. A filter that takes a good one for a noisy one would not learn the bias.

mod climb_test;
mod model_doubt;

pub(super) use climb_test::{ModelError, Segment, TestedFix};

use super::noise_ratio::{CorrelatedNoiseRatio, NoiseRatio, SensorNoiseRatios};
use super::state::State;
use super::state_index::StateIndex;
use super::stuck_torque::StuckTorque;
use crate::cell::CELL_LENGTH_M;
use crate::scalar::Scalar;
use crate::tuning::{Gates, MeasurementNoise, Tuning};
use climb_test::ClimbTest;
use model_doubt::ModelDoubt;

/// What happened to an altitude, besides its use.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum AltitudeEvent {
    /// It is rejected: its innovation is too large.
    Outlier,
    /// The receiver's datum moves by about this much, m.
    Stepped(f32),
    /// The receiver drifts since this cell. Its fixes are rejected from now on.
    DriftBegan(u32),
    /// The drift that began at this cell is over.
    DriftEnded(u32),
    /// The drift lasts too long for one. The fixes are used again.
    DriftBelieved,
    /// The altitude is set from this fix: it is the first one, comes from another source, or follows
    /// a long silence.
    SetAnew,
    /// Altitudes leave the climb of the forces steadily since so many cells, which no receiver does:
    /// the vehicle model is off. The altitude is set from this fix.
    Contradicted {
        /// Number of cells.
        cells: u32,
    },
    /// Altitudes leave the climb of the forces since so many cells, and the torque has not changed
    /// for as long: it is stuck. The altitude is set from this fix.
    TorqueStuck {
        /// Number of cells.
        cells: u32,
    },
}

/// What to do with a fix.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum GateDecision {
    /// Update the state with it.
    Fuse,
    /// Reject it.
    Reject,
    /// Reject it, and return to the model error that was known before the drift. It is as uncertain
    /// as the slope of the drift, %.
    RejectAndUndo(ModelError, f32),
    /// Move the receiver's datum so that the innovation is zero, then update.
    MoveDatum,
    /// Set the altitude from it.
    SetAltitude,
    /// Set the altitude from it, return to the model error that was known before, and widen the slope
    /// by this sigma, %.
    SetAltitudeAndUndo(ModelError, f32),
    /// Set the altitude from it, and widen this state by this sigma, %.
    SetAltitudeAndWiden(StateIndex, f32),
}

/// The state of the drift test.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Drift {
    /// No drift. So many comparisons in a row say otherwise.
    None { contradictions: u8 },
    /// Drift since a cell, with the model error known there, and the distance so far.
    Since {
        cell: u32,
        model_error: ModelError,
        for_m: f32,
    },
    /// The model is off: no test for this distance.
    Believed { for_m: f32 },
}

/// The gate's memory: rejected fixes in a row, drift, and learned noise.
#[derive(Clone, Debug)]
pub(super) struct AltitudeGate {
    rejected: u8,
    offset_m: f32,
    /// Offset of the first of them, and the distance since the last fix that was used, m.
    first_offset_m: f32,
    unused_m: f32,
    silent_s: f32,
    drift: Drift,
    climb_test: ClimbTest,
    doubt: ModelDoubt,
    noise: NoiseRatio,
    gnss_error: CorrelatedNoiseRatio,
    climb_noise: NoiseRatio,
}

/// A fix as the gate sees it.
#[derive(Clone, Copy, Debug)]
pub(super) struct AltitudeInnovation<S> {
    /// Innovation, m.
    pub innovation: S,
    /// Innovation variance, m².
    pub variance: S,
    /// Cell at whose end it is.
    pub cell: u32,
    /// The fix for the climb test.
    pub fix: TestedFix,
    /// Cells up to this one over which the torque has not changed.
    pub resting_cells: u32,
}

impl AltitudeGate {
    /// Creates the gate with the noise known so far.
    #[inline(always)] // See Estimator::new_in().
    pub(super) fn new(noise: &SensorNoiseRatios, tuning: &Tuning) -> Self {
        let MeasurementNoise {
            altitude_ratio_low,
            altitude_ratio_high,
            altitude_ratio_gain,
            ..
        } = tuning.measurement_noise;
        let gates = &tuning.gates;
        Self {
            rejected: 0,
            offset_m: 0.0,
            first_offset_m: 0.0,
            unused_m: 0.0,
            silent_s: 0.0,
            drift: Drift::None { contradictions: 0 },
            climb_test: ClimbTest::default(),
            doubt: ModelDoubt::default(),
            noise: NoiseRatio::new(
                noise.altitude,
                altitude_ratio_low,
                altitude_ratio_high,
                altitude_ratio_gain,
            ),
            gnss_error: CorrelatedNoiseRatio::new(noise.gnss_error, &tuning.measurement_noise),
            climb_noise: NoiseRatio::new(1.0, 1.0, gates.drift_ratio_high, gates.drift_ratio_gain),
        }
    }

    /// Returns learned over assumed variance of a single fix.
    pub(super) const fn noise_ratio(&self) -> f32 {
        self.noise.ratio()
    }

    /// Returns learned over assumed variance of the coloured error.
    pub(super) const fn gnss_error_ratio(&self) -> f32 {
        self.gnss_error.ratio()
    }

    /// Returns the variance of the grade by which climbs differ beyond what the states say, %².
    pub(super) const fn doubt_variance(&self) -> f32 {
        self.doubt.variance()
    }

    /// Returns the time since the last fix, s.
    pub(super) const fn silent_s(&self) -> f32 {
        self.silent_s
    }

    /// Advances over a cell.
    pub(super) fn advance(&mut self, segment: Segment, duration_s: f32) {
        self.gnss_error.advance(duration_s);
        self.silent_s += duration_s;
        self.unused_m += segment.length_m;
        self.climb_test.advance(segment);
        match &mut self.drift {
            Drift::None { .. } => {}
            Drift::Since { for_m, .. } => *for_m += segment.length_m,
            Drift::Believed { for_m } => {
                *for_m -= segment.length_m;
                if *for_m <= 0.0 {
                    self.drift = Drift::None { contradictions: 0 };
                }
            }
        }
    }

    /// Forgets what was learned of the receiver.
    pub(super) fn unlearn(&mut self, tuning: &Tuning) {
        self.start_with(&SensorNoiseRatios::default(), tuning);
    }

    /// Starts anew with the noise known from elsewhere.
    #[inline(never)] // Rare, and called from two places.
    pub(super) fn start_with(&mut self, noise: &SensorNoiseRatios, tuning: &Tuning) {
        *self = Self::new(noise, tuning);
    }

    /// Starts anew, but keeps the learned noise: what comes does not follow from what was.
    #[inline(never)] // Rare, and called from many places.
    pub(super) fn restart(&mut self) {
        self.forget_rejected();
        self.silent_s = 0.0;
        self.drift = Drift::None { contradictions: 0 };
        self.clear_climb_test();
        self.gnss_error.interrupt();
    }

    /// Drops the references of the climb test: the model's error is another one from here on.
    pub(super) fn restart_climb_test(&mut self) {
        self.clear_climb_test();
        if let Drift::None { contradictions } = &mut self.drift {
            *contradictions = 0;
        }
    }

    fn clear_climb_test(&mut self) {
        self.climb_test.clear();
        self.doubt = ModelDoubt::default();
    }

    fn forget_rejected(&mut self) {
        self.rejected = 0;
        self.offset_m = 0.0;
        self.first_offset_m = 0.0;
        self.unused_m = 0.0;
    }

    /// Decides what to do with a fix, given the state before the measurements.
    pub(super) fn decide<S: Scalar>(
        &mut self,
        fix: &AltitudeInnovation<S>,
        state: &State<S>,
        tuning: &Tuning,
    ) -> (GateDecision, Option<AltitudeEvent>) {
        let gates = &tuning.gates;
        let measurement_noise = &tuning.measurement_noise;
        self.silent_s = 0.0;
        let offset_m = fix.innovation.to_f32();
        let variance = fix.variance.to_f32();
        let test_ratio = offset_m * offset_m / variance;
        if let Drift::Since {
            cell,
            model_error,
            for_m,
        } = self.drift
        {
            return self.while_drifting(fix, (cell, model_error, for_m), gates);
        }
        self.noise
            .learn(test_ratio, measurement_noise.largest_innovation);
        if test_ratio > gates.altitude_test_ratio {
            return self.reject(offset_m, gates);
        }
        self.forget_rejected();
        if let Some((cell, model_error, slope_percent)) = self.find_drift(tuning) {
            let cells = fix.cell.saturating_sub(cell);
            if StuckTorque::covers(fix.resting_cells, cells, gates) {
                self.restart();
                return (
                    GateDecision::SetAltitudeAndUndo(model_error, slope_percent),
                    Some(AltitudeEvent::TorqueStuck {
                        cells: Ord::min(cells, fix.resting_cells),
                    }),
                );
            }
            self.drift = Drift::Since {
                cell,
                model_error,
                for_m: 0.0,
            };
            self.clear_climb_test();
            self.gnss_error.interrupt();
            return (
                GateDecision::RejectAndUndo(model_error, slope_percent),
                Some(AltitudeEvent::DriftBegan(cell)),
            );
        }
        let model_error = || ModelError::of(state);
        self.climb_test
            .add(fix.cell, &fix.fix, &model_error, f32::INFINITY, gates);
        self.gnss_error.learn(offset_m, variance, measurement_noise);
        (GateDecision::Fuse, None)
    }

    /// Rejects a fix whose innovation is too large, or finds that the receiver stepped.
    fn reject(&mut self, offset_m: f32, gates: &Gates) -> (GateDecision, Option<AltitudeEvent>) {
        self.gnss_error.interrupt();
        let agrees =
            (offset_m - self.offset_m).abs() <= gates.receiver_step_agreement * offset_m.abs();
        if self.rejected > 0 && agrees {
            self.rejected = self.rejected.saturating_add(1);
        } else {
            self.rejected = 1;
            self.first_offset_m = offset_m;
        }
        self.offset_m = offset_m;
        if self.rejected < gates.receiver_step_fixes {
            return (GateDecision::Reject, Some(AltitudeEvent::Outlier));
        }
        // A step stays; what goes on with the distance is the model's.
        let grown_m = offset_m.abs() - self.first_offset_m.abs();
        let goes_on = grown_m > gates.receiver_step_agreement * offset_m.abs()
            && 100.0 * offset_m.abs() > gates.contradiction_percent * self.unused_m;
        if goes_on {
            let sigma_percent = 100.0 * offset_m / Scalar::max(self.unused_m, 10.0);
            let cells = (self.unused_m / CELL_LENGTH_M) as u32 + 1;
            self.restart();
            return (
                GateDecision::SetAltitudeAndWiden(StateIndex::Wind, sigma_percent),
                Some(AltitudeEvent::Contradicted { cells }),
            );
        }
        self.forget_rejected();
        self.clear_climb_test();
        (
            GateDecision::MoveDatum,
            Some(AltitudeEvent::Stepped(offset_m)),
        )
    }

    /// Returns the cell since which fixes climb unlike the road, the model error known there, and the
    /// slope of the difference, %, once enough comparisons say so.
    fn find_drift(&mut self, tuning: &Tuning) -> Option<(u32, ModelError, f32)> {
        let gates = &tuning.gates;
        let result = self.climb_test.take_result()?;
        let Drift::None { contradictions } = &mut self.drift else {
            return None;
        };
        let ratio = self.climb_noise.ratio();
        self.doubt.compare(&result, ratio, gates);
        self.climb_noise.learn(
            Scalar::min(result.mean / ratio, gates.drift_largest_mean),
            tuning.measurement_noise.largest_innovation,
        );
        if result.test_ratio <= gates.drift_sigmas * gates.drift_sigmas * ratio {
            *contradictions = 0;
            return None;
        }
        *contradictions = contradictions.saturating_add(1);
        (*contradictions >= gates.drift_fixes).then_some((
            result.since_cell,
            result.model_error,
            result.slope_percent,
        ))
    }

    fn while_drifting<S: Scalar>(
        &mut self,
        fix: &AltitudeInnovation<S>,
        (since_cell, model_error, for_m): (u32, ModelError, f32),
        gates: &Gates,
    ) -> (GateDecision, Option<AltitudeEvent>) {
        let climbs_again = self.climb_test.take_result().is_some_and(|result| {
            result.compared_m >= gates.drift_end_m && result.test_ratio < gates.drift_end_ratio
        });
        if climbs_again {
            self.restart();
            let event = AltitudeEvent::DriftEnded(since_cell);
            (GateDecision::MoveDatum, Some(event))
        } else if for_m > gates.drift_longest_m {
            self.restart();
            self.drift = Drift::Believed {
                for_m: gates.drift_believed_m,
            };
            let off_percent = 100.0 * fix.innovation.to_f32() / for_m;
            let event = AltitudeEvent::DriftBelieved;
            (
                GateDecision::SetAltitudeAndWiden(StateIndex::Bias, off_percent),
                Some(event),
            )
        } else {
            self.climb_test.add(
                fix.cell,
                &fix.fix,
                &|| model_error,
                gates.drift_end_m,
                gates,
            );
            (GateDecision::Reject, None)
        }
    }
}
