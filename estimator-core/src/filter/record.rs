//! What a step of the filter leaves for smoothing.

use super::backward::break_vector;
use super::gate::AltitudeEvent;
use super::motion::Motion;
use super::state::{ALTITUDE, GNSS_ERROR, STATES, State};
use super::update::{Applied, Observation};
use crate::cell::Place;
use crate::scalar::Scalar;

/// What a step did to the chain of cells.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Link {
    /// Follows from the step before.
    Chained,
    /// The altitude was set from a fix, whose error it shares from then on.
    AltitudeSet,
    /// A gap: speed, slope and altitude begin anew; bias, scale and GNSS error go on.
    Broken,
    /// A gap, with the altitude set behind it.
    BrokenAltitudeSet,
}

impl Link {
    /// Whether the altitude was set from a fix.
    pub(super) const fn sets_altitude(self) -> bool {
        matches!(self, Self::AltitudeSet | Self::BrokenAltitudeSet)
    }

    /// Whether there was a gap.
    pub(super) const fn breaks(self) -> bool {
        matches!(self, Self::Broken | Self::BrokenAltitudeSet)
    }
}

/// The way back over a step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Trace<S> {
    /// How the states moved into this cell.
    pub motion: Motion<S>,
    /// What else happened before the measurements.
    pub link: Link,
    /// The speed, if there was one.
    pub speed: Option<Applied<S>>,
    /// The altitude, if there was one.
    pub altitude: Option<Applied<S>>,
}

impl<S: Scalar> Trace<S> {
    /// Carries over this step what a state is off, in the mean, because something is missing from
    /// the model, without which this cell climbs `missing_climb_m` less than the model reads.
    /// Returns what the innovation of the altitude is off by then.
    ///
    /// The filter is linear, so this is the derivative of its innovations, divided by the amount
    /// of what is missing (B. Rosenberg, "Random coefficients models", Annals of Economic and
    /// Social Measurement 2:399, 1973; P. de Jong, "The diffuse Kalman filter", Annals of
    /// Statistics 19:1073, 1991). What is missing is taken for a part of the slope that is read,
    /// as the bias is, and not for a force that acts on the speed: drivers answer the road, so
    /// that force and road are no strangers, and only the altitude can tell one from the other.
    pub fn carry_error(&self, error: &mut [S; STATES], missing_climb_m: S) -> Option<S> {
        if self.link.breaks() {
            break_vector(error);
        } else {
            self.motion.forward_vector(error);
            error[ALTITUDE] -= missing_climb_m;
        }
        if self.link.sets_altitude() {
            error[ALTITUDE] = -error[GNSS_ERROR];
        }
        let mut measure = |applied: &Option<Applied<S>>, observation: Observation| {
            applied.as_ref().map(|applied| {
                let seen = observation.of(error);
                for (error, gain) in error.iter_mut().zip(&applied.gain) {
                    *error -= *gain * seen;
                }
                seen
            })
        };
        measure(&self.speed, Observation::Energy);
        measure(&self.altitude, Observation::Altitude)
    }

    /// What was measured, the last first.
    #[inline(always)]
    pub(super) fn measurements(&self) -> impl Iterator<Item = (Observation, &Applied<S>)> {
        let altitude = self.altitude.as_ref().map(|a| (Observation::Altitude, a));
        let speed = self.speed.as_ref().map(|s| (Observation::Energy, s));
        altitude.into_iter().chain(speed)
    }

    /// Takes a vector of the smoother's back over all but the measurements.
    #[inline]
    pub(super) fn retreat_behind_measurements(&self, vector: &mut [S; STATES]) {
        if self.link.sets_altitude() {
            let step = -vector[ALTITUDE];
            vector[GNSS_ERROR] += step;
            vector[ALTITUDE] = S::ZERO;
        }
        if self.link.breaks() {
            break_vector(vector);
        } else {
            self.motion.transpose_vector(vector);
        }
    }
}

/// One step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Moved<S> {
    /// Where and when.
    pub place: Place,
    /// The way back.
    pub trace: Trace<S>,
    /// What became of the altitude, if more than that it was used.
    pub event: Option<AltitudeEvent>,
}

impl<S: Scalar> Record<S> {
    /// The step alone.
    #[must_use]
    pub const fn moved(&self) -> Moved<S> {
        Moved {
            place: self.place,
            trace: self.trace,
            event: self.event,
        }
    }
}

/// One step, and where it led.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Record<S> {
    /// Where and when.
    pub place: Place,
    /// The way back.
    pub trace: Trace<S>,
    /// The state at the cell's end, measurements included.
    pub state: State<S>,
    /// What became of the altitude, if more than that it was used.
    pub event: Option<AltitudeEvent>,
}
