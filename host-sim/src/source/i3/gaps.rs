//! Gaps of the recording, over which the publishers interpolated.

use super::trip::TripRow;
use std::ops::Range;

/// Shortest gap, s. Over this time no driver keeps speed, torque and acceleration all straight to the
/// last digit: none of the 25 trips has such a piece of 2 s outside a gap.
const SHORTEST_S: f64 = 3.0;
/// Twice the rounding of a digit on each of three rows.
const ROUNDING: f64 = 0.020_1;
/// Ratio of km/h to m/s: the speed is rounded in km/h.
const KMH_PER_MPS: f64 = 3.6;

/// Returns the gaps as the indices of the row before and the row after each. A gap is where speed and
/// at least one of torque and acceleration run straight while the car moves.
pub(super) fn gaps(rows: &[TripRow]) -> Vec<Range<usize>> {
    let mut gaps = Vec::new();
    let mut start = 0;
    for middle in 1..rows.len() {
        if middle + 1 < rows.len() && is_straight(&rows[middle - 1..=middle + 1]) {
            continue;
        }
        // Rows `start` to `middle` lie on straight lines.
        if is_gap(rows, start, middle) {
            gaps.push(start..middle);
        }
        start = middle;
    }
    gaps
}

fn is_gap(rows: &[TripRow], start: usize, end: usize) -> bool {
    let (first, last) = (&rows[start], &rows[end]);
    let moves = [first, last]
        .iter()
        .any(|row| row.speed_mps.is_some_and(|mps| mps > 0.0));
    moves && last.time_s - first.time_s >= SHORTEST_S
}

/// Returns whether three rows lie on a straight line in all that is known of motion; false if that is
/// speed alone.
fn is_straight(rows: &[TripRow]) -> bool {
    let straight = |of: fn(&TripRow) -> Option<f64>| {
        let [a, b, c] = [of(&rows[0])?, of(&rows[1])?, of(&rows[2])?];
        Some((a - 2.0 * b + c).abs() <= ROUNDING)
    };
    let speed = straight(|row| row.speed_mps.map(|mps| mps * KMH_PER_MPS));
    let others = [
        straight(|row| row.motor_torque_nm),
        straight(|row| row.acceleration_mps2),
    ];
    let known = others.into_iter().flatten();
    speed == Some(true) && known.clone().count() > 0 && known.clone().all(|is| is)
}
