//! Friction brakes, which no column has: where the car slows down more than its motor explains.

use super::comparison::{Differences, differences};
use super::trips::{JudgedTrip, Kind};
use crate::inertial_judge::{Window, windows_of};

/// Length of a piece of road on which braking is looked for, m.
const PIECE_M: f64 = 20.0;
/// Grade, %, by which the bare model exceeds the judge under friction brakes: 0.3 m/s².
const EXCESS_PERCENT: f64 = 3.0;
/// Least deceleration under brakes, m/s².
const SLOWING_MPS2: f64 = 0.5;

/// A trip with and without the windows in which friction brakes were on.
#[derive(Clone, Debug)]
pub(super) struct Braking {
    /// Part of the pieces of road with friction brakes.
    pub(super) part_of_road: f64,
    /// Part of the windows with such a piece.
    pub(super) part_of_windows: f64,
    /// Smoothed estimates in windows without.
    pub(super) without: Option<Differences>,
}

/// Looks for braking, and compares the windows without it.
pub(super) fn braking(trip: &JudgedTrip, windows: &[Window]) -> Braking {
    let pieces = windows_of(&trip.profile, PIECE_M);
    let brakes: Vec<&Window> = pieces
        .iter()
        .filter(|piece| is_braked(trip, piece))
        .collect();
    let is_free = |window: &&Window| {
        let touches = |piece: &&&Window| piece.from_m < window.to_m && piece.to_m > window.from_m;
        !brakes.iter().any(|piece| touches(&piece))
    };
    let free: Vec<Window> = windows.iter().filter(is_free).copied().collect();
    let part = |count: usize, of: usize| count as f64 / of.max(1) as f64;
    Braking {
        part_of_road: part(brakes.len(), pieces.len()),
        part_of_windows: 1.0 - part(free.len(), windows.len()),
        without: differences(&free, |window| trip.grade(Kind::Smoothed, window)),
    }
}

fn is_braked(trip: &JudgedTrip, piece: &Window) -> bool {
    let excess = |(grade_percent, _): (f64, f64)| grade_percent - piece.grade_percent;
    piece.acceleration_mps2 < -SLOWING_MPS2
        && trip
            .grade(Kind::Bare, piece)
            .is_some_and(|bare| excess(bare) > EXCESS_PERCENT)
}
