//! What is found on a trip.

use super::brakes::{Braking, braking};
use super::comparison::{Differences, differences};
use super::own_errors::{OwnErrors, own_errors};
use super::trips::{JudgedTrip, Kind};
use crate::inertial_judge::Window;

/// Lengths of the windows over which grades are compared, m.
pub(super) const WINDOWS_M: [f64; 2] = [100.0, 300.0];

/// A trip with all that was found on it.
#[derive(Clone, Debug)]
pub(super) struct Found {
    pub(super) trip: JudgedTrip,
    /// The judge's windows of each length.
    pub(super) windows: [Vec<Window>; 2],
    /// Of each length and kind.
    pub(super) differences: [[Option<Differences>; Kind::ALL.len()]; 2],
    /// Of each estimate with the effects that were found, over the long windows.
    pub(super) with_effects: [Option<Differences>; Kind::ESTIMATES.len()],
    pub(super) own: OwnErrors,
    pub(super) braking: Braking,
}

impl Found {
    /// Judges a trip.
    pub(super) fn of(trip: JudgedTrip) -> Self {
        let windows = WINDOWS_M.map(|window_m| trip.windows(window_m));
        let of = |windows: &[Window]| {
            Kind::ALL.map(|kind| differences(windows, |window| trip.grade(kind, window)))
        };
        let with_effects =
            |at: usize| differences(&windows[1], |window| trip.with_effects.grade(at, window));
        Self {
            differences: [of(&windows[0]), of(&windows[1])],
            with_effects: std::array::from_fn(with_effects),
            own: own_errors(&trip),
            braking: braking(&trip, &windows[1]),
            windows,
            trip,
        }
    }
}
