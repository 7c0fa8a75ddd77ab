//! Which altitudes to believe.
//!
//! * A fix whose innovation is beyond what its variance allows is left out. A single one is an
//!   outlier. Several in a row, all off by about as much, are a step of the receiver (other
//!   satellites, a street canyon): its datum moves by as much, and how far is as unsure as the
//!   altitude was; altitude, slope, bias and scale stay what they were.
//! * Fixes that climb unlike the vehicle model over hundreds of metres drift: they are left out
//!   until they climb with it again, and what they taught meanwhile of the model is undone. If
//!   they never do, it is the model that is off, and they are believed.
//! * After another source took over, or a long silence, the altitude is set anew, and only that.
//!
//! How noisy single fixes are and how far the slow error wanders is learned: receivers differ by
//! a factor of ten in both. A gate that takes a noisy one for a good one would pick the fixes that
//! please it, and a filter that takes a good one for a noisy one would not learn the bias from it.

use super::climb::{Climb, Correction, Fixed, Way};
use super::learned::{SensorNoise, SlowSpread, Spread};
use super::state::State;
use crate::scalar::Scalar;

/// Normalised squared innovation beyond which a fix is left out: five standard deviations. Errors
/// among houses have heavier tails than the normal distribution.
const LIMIT: f32 = 25.0;
/// Fixes left out in a row before they are believed after all.
const PATIENCE: u8 = 4;
/// A step is one if the fixes left out agree within this part of their offset.
const AGREEMENT: f32 = 0.5;

/// Normalised squared difference of the climbs below which fixes that drifted do no longer.
const CLIMBS: f32 = 4.0;
/// Largest mean that teaches what is usual: a drift is not.
const LARGEST_LESSON: f32 = 2.0;
/// Fixes compared in a row that must say so.
const CERTAINTY: u8 = 3;
/// Way over which they must climb with the model again, m.
const STEADY_M: f32 = 300.0;
/// Way after which it is the model that is off, and for how long it is then, m.
const LONGEST_DRIFT_M: f32 = 2_500.0;
const MODEL_IS_OFF_M: f32 = 5_000.0;

/// Time over which the slow error of GNSS is told from the receiver's noise, s.
const ERROR_STRETCH_S: f32 = 16.0;

/// What became of an altitude, beyond being used.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum AltitudeEvent {
    /// Left out: it did not fit.
    Outlier,
    /// The receiver's slow error stepped by about this much, m.
    Stepped(f32),
    /// It climbs unlike the road since this cell, and is left out from now on.
    DriftBegan(u32),
    /// The drift that began at this cell is over.
    DriftEnded(u32),
    /// What looked like a drift lasts too long for one: it is believed.
    DriftBelieved,
    /// The altitude was set from it: the first one, from another source, or after a long silence.
    SetAnew,
}

/// What to do with a fix.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Verdict {
    /// Fuse it.
    Fuse,
    /// Leave it out.
    Reject,
    /// Leave it out, and return to what was known of the model before fixes drifted.
    Undo(Correction),
    /// Move the datum of the receiver so that it fits.
    MoveDatum,
    /// Set the altitude from it: there was none, or it counts from another datum.
    SetAnew,
    /// The same, and the slope that the model reads may be off by this much, %.
    Believe(f32),
}

/// Whether fixes drift.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Drift {
    /// No; so many fixes in a row say otherwise.
    None { doubts: u8 },
    /// Since a cell, where this was known of the model, and left out for a way so far.
    Since {
        cell: u32,
        known: Correction,
        for_m: f32,
    },
    /// The model is off, for this way yet.
    Believed { for_m: f32 },
}

/// Remembers the fixes left out in a row, and how noisy fixes were.
#[derive(Clone, Debug)]
pub(super) struct Gate {
    rejected: u8,
    offset_m: f32,
    silent_s: f32,
    drift: Drift,
    climb: Climb,
    spread: Spread,
    error_spread: SlowSpread,
    climb_spread: Spread,
}

/// A fix as the filter sees it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Judged<S> {
    /// Measured minus predicted, m.
    pub innovation: S,
    /// Variance of that, m².
    pub variance: S,
    /// Cell at whose end it is.
    pub cell: u32,
    /// For the comparison of climbs.
    pub fixed: Fixed,
    /// Normalised squared difference of the climbs from which it drifts.
    pub drifts: f32,
}

impl Gate {
    /// With nothing left out, and what is known of the noise.
    pub(super) fn new(noise: &SensorNoise) -> Self {
        Self {
            rejected: 0,
            offset_m: 0.0,
            silent_s: 0.0,
            drift: Drift::None { doubts: 0 },
            climb: Climb::default(),
            // A fifth to ten times the believed sigma; some thirty fixes.
            spread: Spread::new(noise.altitude, 0.05, 100.0, 0.03),
            error_spread: SlowSpread::new(noise.gnss_error, ERROR_STRETCH_S),
            // Up to three times what the slow error's sigma says of its growth; some hundred fixes.
            climb_spread: Spread::new(1.0, 1.0, 10.0, 0.005),
        }
    }

    /// Learned over believed variance of a single fix.
    pub(super) const fn spread(&self) -> f32 {
        self.spread.ratio()
    }

    /// Learned over believed variance of the slow error.
    pub(super) const fn error_spread(&self) -> f32 {
        self.error_spread.ratio()
    }

    /// Time since the last fix, s.
    pub(super) const fn silent_s(&self) -> f32 {
        self.silent_s
    }

    /// Goes over a cell.
    pub(super) fn pass(&mut self, way: Way, duration_s: f32) {
        self.error_spread.pass(duration_s);
        self.silent_s += duration_s;
        self.climb.drive(way);
        match &mut self.drift {
            Drift::None { .. } => {}
            Drift::Since { for_m, .. } => *for_m += way.length_m,
            Drift::Believed { for_m } => {
                *for_m -= way.length_m;
                if *for_m <= 0.0 {
                    self.drift = Drift::None { doubts: 0 };
                }
            }
        }
    }

    /// Gives up what was learned of the receiver.
    pub(super) fn unlearn(&mut self) {
        *self = Self::new(&SensorNoise::default());
    }

    /// What came before says nothing of what comes.
    pub(super) fn forget(&mut self) {
        self.forget_rejected();
        self.silent_s = 0.0;
        self.drift = Drift::None { doubts: 0 };
        self.climb.forget();
        self.error_spread.interrupt();
    }

    fn forget_rejected(&mut self) {
        self.rejected = 0;
        self.offset_m = 0.0;
    }

    /// Judges a fix by how it fits the state before the measurements.
    pub(super) fn judge<S: Scalar>(
        &mut self,
        judged: &Judged<S>,
        state: &State<S>,
    ) -> (Verdict, Option<AltitudeEvent>) {
        self.silent_s = 0.0;
        let offset_m = judged.innovation.to_f32();
        let variance = judged.variance.to_f32();
        let normalised = offset_m * offset_m / variance;
        if let Drift::Since { cell, known, for_m } = self.drift {
            return self.while_drifting(judged, (cell, known, for_m));
        }
        self.spread.learn(normalised);
        if normalised > LIMIT {
            return self.beyond(offset_m);
        }
        self.forget_rejected();
        if let Some((cell, known)) = self.found_drift(judged.drifts) {
            self.drift = Drift::Since {
                cell,
                known,
                for_m: 0.0,
            };
            self.climb.forget();
            self.error_spread.interrupt();
            return (Verdict::Undo(known), Some(AltitudeEvent::DriftBegan(cell)));
        }
        let known = || Correction::of(state);
        self.climb
            .take(judged.cell, &judged.fixed, known, f32::INFINITY);
        self.error_spread.learn(offset_m, variance);
        (Verdict::Fuse, None)
    }

    /// A single fix that does not fit.
    fn beyond(&mut self, offset_m: f32) -> (Verdict, Option<AltitudeEvent>) {
        self.error_spread.interrupt();
        let agrees = (offset_m - self.offset_m).abs() <= AGREEMENT * offset_m.abs();
        self.rejected = if agrees {
            self.rejected.saturating_add(1)
        } else {
            1
        };
        self.offset_m = offset_m;
        if self.rejected < PATIENCE {
            return (Verdict::Reject, Some(AltitudeEvent::Outlier));
        }
        self.forget_rejected();
        self.climb.forget();
        (Verdict::MoveDatum, Some(AltitudeEvent::Stepped(offset_m)))
    }

    /// Since which cell fixes climb unlike the road, once that is certain, and what was known there.
    fn found_drift(&mut self, drifts: f32) -> Option<(u32, Correction)> {
        let misfit = self.climb.compared()?;
        let Drift::None { doubts } = &mut self.drift else {
            return None;
        };
        let spread = self.climb_spread.ratio();
        self.climb_spread
            .learn(Scalar::min(misfit.mean / spread, LARGEST_LESSON));
        if misfit.normalised <= drifts * spread {
            *doubts = 0;
            return None;
        }
        *doubts += 1;
        (*doubts >= CERTAINTY).then_some((misfit.since_cell, misfit.known))
    }

    fn while_drifting<S: Scalar>(
        &mut self,
        judged: &Judged<S>,
        (since_cell, known, for_m): (u32, Correction, f32),
    ) -> (Verdict, Option<AltitudeEvent>) {
        let climbs_again = self
            .climb
            .compared()
            .is_some_and(|misfit| misfit.compared_m >= STEADY_M && misfit.normalised < CLIMBS);
        if climbs_again {
            self.forget();
            let event = AltitudeEvent::DriftEnded(since_cell);
            (Verdict::MoveDatum, Some(event))
        } else if for_m > LONGEST_DRIFT_M {
            self.forget();
            self.drift = Drift::Believed {
                for_m: MODEL_IS_OFF_M,
            };
            let off_percent = 100.0 * judged.innovation.to_f32() / for_m;
            let event = AltitudeEvent::DriftBelieved;
            (Verdict::Believe(off_percent), Some(event))
        } else {
            self.climb
                .take(judged.cell, &judged.fixed, || known, STEADY_M);
            (Verdict::Reject, None)
        }
    }
}
