//! The judge against itself: pieces of road that two trips drive in the same direction.
//!
//! Nothing but the judge's grade finds them. Pieces of 1.5 km of one trip are laid on the other;
//! where at least three in a row fit at about the same place, the road is the same.

use super::trips::JudgedTrip;
use crate::inertial_judge::{InertialProfile, ProfilePoint, Stretch};
use crate::numeric::statistics::{deviation, mean};

/// Step of the profiles that are laid over each other, m.
const GRID_M: f64 = 5.0;
/// Base of their grades, m.
const BASE_STEPS: usize = 20;
/// Length of a piece, and distance between two of them, in steps.
const PIECE_STEPS: usize = 300;
const PIECE_EVERY: usize = 150;
/// Farthest shift between two trips over the same road, steps: where the recordings began.
const FARTHEST_STEPS: usize = 250;
/// Least correlation of pieces of the same road.
const LEAST_CORRELATION: f64 = 0.9;
/// Most that the shift changes from piece to piece, steps: lanes, wheel radius.
const WANDER_STEPS: usize = 6;
/// Least number of pieces in a row.
const FEWEST_PIECES: usize = 3;

/// A piece of road that two trips share.
#[derive(Clone, Copy, Debug)]
struct SharedPiece {
    /// Middle half of the piece in the first trip, m.
    from_m: f64,
    /// Distance in the second trip less that in the first, m.
    shift_m: f64,
}

/// Two trips over the same road.
#[derive(Clone, Debug)]
pub(super) struct Repeat {
    pub(super) trips: [String; 2],
    pub(super) is_winter: bool,
    pub(super) shared_m: f64,
    /// Difference of both judges, mean: of their offsets, %.
    pub(super) offset_percent: f64,
    /// One judge's noise over windows of each length: root mean square of the differences without
    /// the offset, over the root of two, %.
    pub(super) noise_percent: [f64; 2],
    /// Change of the difference for each m/s² that one accelerates more, %: pitch of the body.
    pub(super) pitch_percent: f64,
}

/// Finds the pairs of trips that share a road, and compares their judges over these windows, m.
pub(super) fn repeats(trips: &[JudgedTrip], windows_m: [f64; 2]) -> Vec<Repeat> {
    let grades: Vec<Vec<f64>> = trips.iter().map(|trip| grades(&trip.profile)).collect();
    let mut found = Vec::new();
    for (k, a) in trips.iter().enumerate() {
        for (l, b) in trips.iter().enumerate().skip(k + 1) {
            if a.is_winter() != b.is_winter() {
                continue;
            }
            let pieces = shared(&grades[k], &grades[l]);
            found.extend(compared(a, b, &pieces, windows_m));
        }
    }
    found
}

/// Returns mean grades over the base at each step of a trip; NaN where there is none.
fn grades(profile: &InertialProfile) -> Vec<f64> {
    let end_m = profile
        .points()
        .last()
        .map_or(0.0, |point| point.distance_m);
    let steps = (end_m / GRID_M) as usize;
    let points: Vec<Option<ProfilePoint>> = (0..=steps)
        .map(|step| profile.at_distance(step as f64 * GRID_M))
        .collect();
    let grade = |base: &[Option<ProfilePoint>]| {
        let stretch = Stretch::between(&base[0]?, &base[BASE_STEPS]?)?;
        Some(100.0 * stretch.sine())
    };
    points
        .windows(BASE_STEPS + 1)
        .map(|base| grade(base).unwrap_or(f64::NAN))
        .collect()
}

/// Lays pieces of one trip on the other, and keeps those that fit in a row.
fn shared(a: &[f64], b: &[f64]) -> Vec<SharedPiece> {
    let mut rows: Vec<Vec<(usize, isize)>> = Vec::new();
    let mut start = 0;
    while start + PIECE_STEPS <= a.len() {
        if let Some(shift) = best_shift(a, b, start) {
            let follows = |row: &Vec<(usize, isize)>| {
                row.last().is_some_and(|&(last, of)| {
                    last + PIECE_EVERY == start && of.abs_diff(shift) <= WANDER_STEPS
                })
            };
            match rows.last_mut().filter(|row| follows(row)) {
                Some(row) => row.push((start, shift)),
                None => rows.push(vec![(start, shift)]),
            }
        }
        start += PIECE_EVERY;
    }
    rows.retain(|row| row.len() >= FEWEST_PIECES);
    let piece = |(start, shift): (usize, isize)| SharedPiece {
        from_m: (start + PIECE_EVERY / 2) as f64 * GRID_M,
        shift_m: shift as f64 * GRID_M,
    };
    rows.into_iter().flatten().map(piece).collect()
}

/// Returns the shift at which a piece fits best; `None` if it fits nowhere.
fn best_shift(a: &[f64], b: &[f64], start: usize) -> Option<isize> {
    let piece = &a[start..start + PIECE_STEPS];
    let first = start.saturating_sub(FARTHEST_STEPS);
    let last = (start + FARTHEST_STEPS).min(b.len().checked_sub(PIECE_STEPS)?);
    let mut best = (LEAST_CORRELATION, None);
    for place in first..=last {
        let fits = correlation(piece, &b[place..place + PIECE_STEPS]);
        if fits > best.0 {
            best = (fits, Some(place as isize - start as isize));
        }
    }
    best.1
}

/// Returns the correlation of two pieces; NaN if one has a break.
fn correlation(a: &[f64], b: &[f64]) -> f64 {
    let count = a.len() as f64;
    let (mut sa, mut sb, mut aa, mut bb, mut ab) = (0.0, 0.0, 0.0, 0.0, 0.0);
    for (x, y) in a.iter().zip(b) {
        sa += x;
        sb += y;
        aa += x * x;
        bb += y * y;
        ab += x * y;
    }
    (ab - sa * sb / count) / ((aa - sa * sa / count) * (bb - sb * sb / count)).sqrt()
}

/// The difference of two judges over a window, %, and of their accelerations, m/s².
fn difference(
    [a, b]: [&InertialProfile; 2],
    from_m: f64,
    shift_m: f64,
    window_m: f64,
) -> Option<(f64, f64)> {
    let judged = |profile: &InertialProfile, from_m: f64| {
        let to_m = from_m + window_m;
        Stretch::between(&profile.at_distance(from_m)?, &profile.at_distance(to_m)?)
    };
    let (x, y) = (judged(a, from_m)?, judged(b, from_m + shift_m)?);
    let excess_percent = 100.0 * (x.sine() - y.sine());
    Some((excess_percent, x.acceleration_mps2 - y.acceleration_mps2))
}

fn compared(
    a: &JudgedTrip,
    b: &JudgedTrip,
    pieces: &[SharedPiece],
    windows_m: [f64; 2],
) -> Option<Repeat> {
    let way_m = PIECE_EVERY as f64 * GRID_M;
    let of_length = |window_m: f64| -> Vec<(f64, f64)> {
        let each = (way_m / window_m).floor() as usize;
        let places = pieces.iter().flat_map(|piece| {
            (0..each).map(move |k| (piece.from_m + k as f64 * window_m, piece.shift_m))
        });
        places
            .filter_map(|(from_m, shift_m)| {
                difference([&a.profile, &b.profile], from_m, shift_m, window_m)
            })
            .collect()
    };
    let differences = windows_m.map(of_length);
    if pieces.is_empty() || differences.iter().any(|of| of.len() < 5) {
        return None;
    }
    Some(Repeat {
        trips: [a.name.clone(), b.name.clone()],
        is_winter: a.is_winter(),
        shared_m: pieces.len() as f64 * way_m,
        offset_percent: mean(&grades_of(&differences[1])),
        noise_percent: [noise(&differences[0]), noise(&differences[1])],
        pitch_percent: slope(&differences[0]),
    })
}

fn grades_of(differences: &[(f64, f64)]) -> Vec<f64> {
    differences.iter().map(|of| of.0).collect()
}

/// Returns the noise of one judge: both have the same.
fn noise(differences: &[(f64, f64)]) -> f64 {
    deviation(&grades_of(differences)) / 2.0_f64.sqrt()
}

/// Returns the slope of the difference over that of the accelerations, % per m/s².
fn slope(differences: &[(f64, f64)]) -> f64 {
    let centre = mean(&grades_of(differences));
    let pushes: Vec<f64> = differences.iter().map(|of| of.1).collect();
    let push = mean(&pushes);
    let pairs = differences.iter().map(|of| (of.0 - centre, of.1 - push));
    let (xy, xx) = pairs.fold((0.0, 0.0), |(xy, xx), (y, x)| (xy + x * y, xx + x * x));
    xy / xx
}
