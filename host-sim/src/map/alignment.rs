//! From matched points to smooth distances along the road.

use super::local_fit;
use super::matching::{Place, TrackPoint};
use std::ops::Range;

/// Half width over which the offset between road and odometer is smoothed, m. Position noise of
/// 2-3 m is uneven over this; an odometer 1 % wrong shifts the offset by 1 m, evenly.
const OFFSET_REACH_M: f64 = 100.0;

/// Points of a run that follow the road without a break.
#[derive(Clone, Debug, PartialEq)]
pub struct Stretch {
    /// Which points of the run.
    pub points: Range<usize>,
    /// Distance along the road of each.
    pub distance_m: Vec<f64>,
}

/// The stretches of a run on the road. Points without a position belong to a stretch if it goes
/// on behind them (matching has compared that with the odometer).
pub fn stretches(track: &[TrackPoint], places: &[Place]) -> Vec<Stretch> {
    let mut found: Vec<Vec<(usize, f64)>> = Vec::new();
    let mut open: Vec<(usize, f64)> = Vec::new();
    for (i, place) in places.iter().enumerate() {
        match *place {
            Place::OnRoad(distance_m) => open.push((i, distance_m)),
            Place::NoPosition => {}
            Place::OffRoad | Place::Opposite => {
                if !open.is_empty() {
                    found.push(std::mem::take(&mut open));
                }
            }
        }
    }
    if !open.is_empty() {
        found.push(open);
    }
    found.iter().map(|on| smoothed(track, on)).collect()
}

/// A stretch through the matched points `on`, each with its raw distance along the road.
fn smoothed(track: &[TrackPoint], on: &[(usize, f64)]) -> Stretch {
    let odometer_m: Vec<f64> = on.iter().map(|&(i, _)| track[i].odometer_m).collect();
    let offset_m: Vec<f64> = on
        .iter()
        .zip(&odometer_m)
        .map(|(&(_, distance_m), odometer_m)| distance_m - odometer_m)
        .collect();
    let offset_m = local_fit::smooth::<2>(&odometer_m, &offset_m, OFFSET_REACH_M);
    let points = on[0].0..on[on.len() - 1].0 + 1;
    let mut after = 0;
    let distance_m = points
        .clone()
        .map(|i| {
            let here_m = track[i].odometer_m;
            while on[after].0 < i {
                after += 1;
            }
            if on[after].0 == i {
                return here_m + offset_m[after];
            }
            // Without a position: the offset changes evenly from the one known to the next.
            let (from_m, to_m) = (odometer_m[after - 1], odometer_m[after]);
            let part = (here_m - from_m) / (to_m - from_m).max(f64::MIN_POSITIVE);
            here_m + offset_m[after - 1] + part * (offset_m[after] - offset_m[after - 1])
        })
        .collect();
    Stretch { points, distance_m }
}
