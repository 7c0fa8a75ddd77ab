//! What a step of the filter leaves for smoothing.

use super::state::State;
use super::transition::Transition;
use super::update::Update;
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
}

/// One step: all that smoothing needs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Record<S> {
    /// Where and when.
    pub place: Place,
    /// The step into this cell.
    pub transition: Transition<S>,
    /// What else happened before the measurements.
    pub link: Link,
    /// State before the measurements.
    pub predicted: State<S>,
    /// The speed, if there was one.
    pub speed: Option<Update<S>>,
    /// The altitude, if there was one.
    pub altitude: Option<Update<S>>,
}

impl<S: Scalar> Record<S> {
    /// State after the measurements.
    #[must_use]
    pub fn filtered(&self) -> State<S> {
        let mut state = self.predicted;
        for update in [&self.speed, &self.altitude].into_iter().flatten() {
            update.apply(&mut state);
        }
        state
    }

    /// In another number.
    #[must_use]
    pub fn cast<T: Scalar>(&self) -> Record<T> {
        Record {
            place: self.place,
            transition: self.transition.cast(),
            link: self.link,
            predicted: self.predicted.cast(),
            speed: self.speed.as_ref().map(Update::cast),
            altitude: self.altitude.as_ref().map(Update::cast),
        }
    }
}
