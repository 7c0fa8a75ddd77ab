//! Where the elevation was measured.
//!
//! The publishers have a point in whole metres every two to five minutes, and a straight line from
//! each to the next. What lies on a line is no measurement, so only the points, where lines meet,
//! count. Flat ends are the first or last point held.

use super::trip::TripRow;
use std::ops::Range;

/// Rounding of the interpolated elevations, m: half a digit, and a little.
const ROUNDING_M: f64 = 0.005_5;
/// Largest difference of a point from a whole metre, m: the slopes of short lines are not exact.
const WHOLE_M: f64 = 0.1;
/// A shorter line, s, is a step or a piece of noise.
const SHORTEST_LINE_S: f64 = 0.9;
/// Lines of this length, s, are no measurement; ...
const LONG_LINE_S: f64 = 10.0;
/// ... if they cover this part of the elevations, these are interpolated.
const LONG_PART: f64 = 0.8;
/// Slopes that differ by less, m/s, are the same: rounding.
const SLOPE_MPS: f64 = 2e-4;
/// Rows by which the end of a line may lie behind the point.
const LATE_ROWS: usize = 10;
/// Elevations that are not interpolated are taken this often, s: they wander for longer.
const THINNED_S: f64 = 5.0;

/// A measured elevation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Point {
    /// Row.
    pub row: usize,
    /// Elevation, m.
    pub altitude_m: f64,
}

/// The measured elevations of a trip.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Points {
    /// The file has none.
    Absent,
    /// The elevation never changes: it is none.
    Frozen(f64),
    /// Points between which the file has straight lines.
    OfLines(Vec<Point>),
    /// Elevations that change all the time, thinned.
    Thinned(Vec<Point>),
}

impl Points {
    /// Returns the points, in order.
    pub(super) fn points(&self) -> &[Point] {
        match self {
            Self::Absent | Self::Frozen(_) => &[],
            Self::OfLines(points) | Self::Thinned(points) => points,
        }
    }

    /// Returns what to tell the user.
    pub(super) fn note(&self) -> Option<String> {
        match self {
            Self::Absent => None,
            Self::Frozen(altitude_m) => Some(format!(
                "Elevation is {altitude_m} m all along: no measurement, left out"
            )),
            Self::OfLines(points) => Some(format!(
                "Elevation is interpolated between points minutes apart: its {} points are kept",
                points.len()
            )),
            Self::Thinned(points) => Some(format!(
                "Elevation is kept every {THINNED_S} s: {} values",
                points.len()
            )),
        }
    }
}

/// A straight piece of the elevation, from row to row, both inclusive.
#[derive(Clone, Copy, Debug)]
struct Line {
    from: usize,
    to: usize,
    from_m: f64,
    per_row_m: f64,
    duration_s: f64,
}

impl Line {
    fn at(&self, row: usize) -> f64 {
        self.from_m + self.per_row_m * (row as f64 - self.from as f64)
    }

    fn slope_mps(&self) -> f64 {
        self.per_row_m * (self.to - self.from) as f64 / self.duration_s
    }
}

/// Finds the measured elevations. None is taken within a gap of the recording.
pub(super) fn points(rows: &[TripRow], gaps: &[Range<usize>]) -> Points {
    let known: Vec<Point> = rows
        .iter()
        .enumerate()
        .filter_map(|(row, of)| {
            let altitude_m = of.altitude_m?;
            Some(Point { row, altitude_m })
        })
        .collect();
    let Some(first) = known.first() else {
        return Points::Absent;
    };
    if known
        .iter()
        .all(|point| point.altitude_m == first.altitude_m)
    {
        return Points::Frozen(first.altitude_m);
    }
    let is_measured = |point: &Point| gaps.iter().all(|gap| !gap.contains(&point.row));
    let lines = lines(rows, &known);
    let duration_s = |lines: &[Line]| lines.iter().map(|line| line.duration_s).sum::<f64>();
    let long: Vec<Line> = lines
        .iter()
        .copied()
        .filter(|line| line.duration_s >= LONG_LINE_S)
        .collect();
    if duration_s(&long) < LONG_PART * duration_s(&lines) {
        let measured = known.into_iter().filter(is_measured);
        return Points::Thinned(thinned(rows, measured));
    }
    Points::OfLines(ends(&lines).into_iter().filter(is_measured).collect())
}

/// Cuts the elevations into the longest pieces that a line through their first value can explain.
fn lines(rows: &[TripRow], known: &[Point]) -> Vec<Line> {
    let mut lines = Vec::new();
    let mut start = 0;
    while start + 1 < known.len() {
        let first = known[start];
        let (mut low, mut high) = (f64::NEG_INFINITY, f64::INFINITY);
        let mut end = start;
        while let Some(next) = known.get(end + 1) {
            let steps = (next.row - first.row) as f64;
            let rise_m = next.altitude_m - first.altitude_m;
            let lowest = low.max((rise_m - 2.0 * ROUNDING_M) / steps);
            let highest = high.min((rise_m + 2.0 * ROUNDING_M) / steps);
            if lowest > highest {
                break;
            }
            (low, high, end) = (lowest, highest, end + 1);
        }
        lines.push(line(rows, &known[start..=end]));
        start = end;
    }
    lines
}

/// Fits a line by least squares.
fn line(rows: &[TripRow], points: &[Point]) -> Line {
    let (first, last) = (points[0], points[points.len() - 1]);
    let count = points.len() as f64;
    let at = |point: &Point| (point.row - first.row) as f64;
    let mean_at = points.iter().map(at).sum::<f64>() / count;
    let mean_m = points.iter().map(|point| point.altitude_m).sum::<f64>() / count;
    let of = |point: &Point| (at(point) - mean_at, point.altitude_m - mean_m);
    let covariance: f64 = points.iter().map(of).map(|(x, y)| x * y).sum();
    let variance: f64 = points.iter().map(of).map(|(x, _)| x * x).sum();
    let per_row_m = covariance / variance;
    Line {
        from: first.row,
        to: last.row,
        from_m: mean_m - per_row_m * mean_at,
        per_row_m,
        duration_s: rows[last.row].time_s - rows[first.row].time_s,
    }
}

/// Returns the points at which lines meet, and the ends that are not held.
fn ends(lines: &[Line]) -> Vec<Point> {
    let whole = |row: usize, altitude_m: f64| {
        let whole_m = altitude_m.round();
        let is_whole = (altitude_m - whole_m).abs() < WHOLE_M;
        is_whole.then_some(Point {
            row,
            altitude_m: whole_m,
        })
    };
    let has_slope = |line: &&Line| line.slope_mps().abs() > SLOPE_MPS;
    let first = lines.first().filter(has_slope);
    let last = lines.last().filter(has_slope);
    let mut points: Vec<Point> = Vec::new();
    points.extend(first.and_then(|line| whole(line.from, line.at(line.from))));
    for pair in lines.windows(2) {
        let (a, b) = (&pair[0], &pair[1]);
        let is_step = a.duration_s.min(b.duration_s) < SHORTEST_LINE_S;
        if is_step || (a.slope_mps() - b.slope_mps()).abs() < SLOPE_MPS {
            continue;
        }
        let row = meeting_row(a, b);
        points.extend(whole(row, 0.5 * (a.at(row) + b.at(row))));
    }
    points.extend(last.and_then(|line| whole(line.to, line.at(line.to))));
    points
}

/// Returns the row at which two lines meet. The first one, as found, ends there or a little later.
fn meeting_row(a: &Line, b: &Line) -> usize {
    let apart_m = b.at(a.to) - a.at(a.to);
    let rows_back = apart_m / (b.per_row_m - a.per_row_m);
    let rows_back = rows_back.clamp(0.0, LATE_ROWS as f64).round() as usize;
    a.to.saturating_sub(rows_back).max(a.from)
}

fn thinned(rows: &[TripRow], measured: impl Iterator<Item = Point>) -> Vec<Point> {
    let mut next_s = f64::NEG_INFINITY;
    measured
        .filter(|point| {
            let time_s = rows[point.row].time_s;
            let is_due = time_s >= next_s;
            if is_due {
                next_s = time_s + THINNED_S;
            }
            is_due
        })
        .collect()
}
