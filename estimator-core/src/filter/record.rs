//! What a step of the filter leaves for smoothing.

use super::backward::BROKEN;
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
            for i in BROKEN {
                vector[i] = S::ZERO;
            }
        } else {
            self.motion.transpose_vector(vector);
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
