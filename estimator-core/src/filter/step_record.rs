//! What a filter step leaves for the smoother.

use super::altitude_gate::AltitudeEvent;
use super::dynamics::Dynamics;
use super::measurement::{Observation, ScalarUpdate};
use super::state_index::StateIndex::{Altitude, GnssError, Scale};
use super::state_index::StateVector;
use crate::cell::{CellEnd, Disagreement};
use crate::scalar::Scalar;

/// A reset of states between the prediction and the measurements.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Reset {
    /// No reset.
    None,
    /// The altitude is set from a fix. From then on it shares the fix's error.
    Altitude,
    /// A gap: speed, slope and altitude start anew; bias, scale and GNSS error go on.
    Gap,
    /// A gap, and the altitude is set behind it.
    GapAndAltitude,
}

impl Reset {
    /// Returns the reset with the altitude set besides.
    pub(super) const fn and_altitude(self) -> Self {
        match self {
            Self::None | Self::Altitude => Self::Altitude,
            Self::Gap | Self::GapAndAltitude => Self::GapAndAltitude,
        }
    }

    /// Returns whether the altitude is set from a fix.
    pub(crate) const fn sets_altitude(self) -> bool {
        matches!(self, Self::Altitude | Self::GapAndAltitude)
    }

    /// Returns whether there is a gap.
    pub(crate) const fn is_gap(self) -> bool {
        matches!(self, Self::Gap | Self::GapAndAltitude)
    }
}

/// What the smoother needs of a filter step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SmootherInput<S> {
    /// How the states moved into the cell.
    pub dynamics: Dynamics<S>,
    /// What was reset before the measurements.
    pub reset: Reset,
    /// The update with the speed, if there was one.
    pub speed: Option<ScalarUpdate<S>>,
    /// The update after it, if there was one: with the altitude, a slope, or the scale.
    pub second: Option<(Observation, ScalarUpdate<S>)>,
    /// Whether the scale was set anew after the measurements. What follows says nothing of the one
    /// before.
    pub scale_set: bool,
}

impl<S: Scalar> SmootherInput<S> {
    /// Propagates the mean error of the state that a missing part of the model causes over this
    /// step. In this cell the road climbs `missing_climb_m` less than the model reads. Returns the
    /// error of the altitude innovation, m; `None` without an altitude.
    ///
    /// The filter is linear, so this is the derivative of its innovations with respect to the
    /// amount of what is missing, times that amount (B. Rosenberg, "Random coefficients models",
    /// Annals of Economic and Social Measurement 2:399, 1973; P. de Jong, "The diffuse Kalman
    /// filter", Annals of Statistics 19:1073, 1991). What is missing is a part of the slope that is
    /// read, as the bias is, and not a force on the speed. Drivers answer the road, so force and
    /// road are correlated, and only the altitude separates them.
    pub fn carry_error(&self, error: &mut StateVector<S>, missing_climb_m: S) -> Option<S> {
        if self.reset.is_gap() {
            error.clear_after_gap();
        } else {
            self.dynamics.forward_vector(error);
            error[Altitude] -= missing_climb_m;
        }
        if self.reset.sets_altitude() {
            error[Altitude] = -error[GnssError];
        }
        let net_traction = self.dynamics.net_traction;
        let mut update = |update: &Option<ScalarUpdate<S>>, observation: Observation| {
            update.as_ref().map(|update| {
                let observed = observation.of(error, net_traction);
                for (error, gain) in error.0.iter_mut().zip(&update.gain.0) {
                    *error -= *gain * observed;
                }
                observed
            })
        };
        update(&self.speed, Observation::Energy);
        let second = self.second.as_ref().and_then(|(observation, second)| {
            update(&Some(*second), *observation).filter(|_| *observation == Observation::Altitude)
        });
        if self.scale_set {
            error[Scale] = S::ZERO;
        }
        second
    }

    /// Returns the update with the altitude, if there was one.
    #[must_use]
    pub fn altitude(&self) -> Option<&ScalarUpdate<S>> {
        let (observation, update) = self.second.as_ref()?;
        (*observation == Observation::Altitude).then_some(update)
    }

    /// Returns the updates, the last one first.
    #[inline(always)]
    pub fn updates(&self) -> impl Iterator<Item = (Observation, &ScalarUpdate<S>)> {
        let second = self
            .second
            .as_ref()
            .map(|(observation, update)| (*observation, update));
        let speed = self.speed.as_ref().map(|s| (Observation::Energy, s));
        second.into_iter().chain(speed)
    }

    /// Takes an adjoint vector back over what followed the updates.
    #[inline]
    pub(crate) fn transpose_scale(&self, vector: &mut StateVector<S>) {
        if self.scale_set {
            vector[Scale] = S::ZERO;
        }
    }

    /// Takes an adjoint vector back over reset and dynamics, behind the updates.
    #[inline(never)] // Long, and called from several places of the smoother.
    pub(crate) fn transpose_prediction(&self, vector: &mut StateVector<S>) {
        if self.reset.sets_altitude() {
            let step = -vector[Altitude];
            vector[GnssError] += step;
            vector[Altitude] = S::ZERO;
        }
        if self.reset.is_gap() {
            vector.clear_after_gap();
        } else {
            self.dynamics.transpose_vector(vector);
        }
    }
}

/// The record of one filter step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StepRecord<S> {
    /// Where and when the cell ends.
    pub end: CellEnd,
    /// What the smoother needs.
    pub smoother_input: SmootherInput<S>,
    /// What happened to the altitude, if more than its use.
    pub event: Option<AltitudeEvent>,
    /// What disagrees in the cell.
    pub disagreement: Disagreement,
    /// Number of cells up to this one in which it disagrees. More than one if it is noticed late.
    pub disagreeing_cells: u32,
    /// True if what disagreed is undone at the cell's end: the cells before are wrong, and the live
    /// estimate is not.
    pub is_undone: bool,
}

impl<S> StepRecord<S> {
    /// Returns what disagrees with the live estimate.
    pub(crate) fn live_disagreement(&self) -> Disagreement {
        if self.is_undone {
            Disagreement::default()
        } else {
            self.disagreement
        }
    }
}
