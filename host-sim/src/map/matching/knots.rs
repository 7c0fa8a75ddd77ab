//! Knots: the points of a run that are matched.
//!
//! Positions come one to ten times a second, and their errors change over tens of metres. So up to
//! 20 m of cells are matched as one: their mean position, at their mean odometer distance. The mean
//! has what each of them says of the offset between road and odometer, because that offset is linear
//! in the position. Where a run starts, ends, or has no positions, and where positions do not follow
//! the odometer, each cell is a knot of its own.

use super::track_point::TrackPoint;
use crate::files::run::RunCell;
use crate::map::geometry::plane::earth_centred;
use std::ops::Range;

/// Cells of a run farther apart than this are not joined, m: rows of the file are missing.
pub(crate) const JOIN_LIMIT_M: f64 = 8.0;
/// Length of the cells of one knot, m: that of half a course, so that chords from knot to knot are
/// those from cell to cell.
const KNOT_M: f64 = 20.0;
/// Largest distance of a position of a knot from the line between its first and its last, m: more
/// than noise and bends of 12 m radius.
const STRAY_M: f64 = 5.0;
/// Metres of a degree of latitude.
const DEGREE_M: f64 = 111_195.0;

/// Cells that are matched as one.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Knot {
    /// Their range in the run. All have a position.
    pub cells: Range<usize>,
    /// Mean of their driven distances, m.
    pub odometer_m: f64,
    /// Mean of their positions, earth-centred, m.
    pub place_m: [f64; 3],
}

impl Knot {
    /// Returns the number of positions, by which prices count.
    pub(crate) const fn weight(&self) -> f64 {
        (self.cells.end - self.cells.start) as f64
    }

    /// Returns true if the knot has more than one cell.
    pub(crate) const fn is_group(&self) -> bool {
        self.cells.end - self.cells.start > 1
    }

    const fn new(cells: Range<usize>, odometer_m: f64, place_m: [f64; 3]) -> Self {
        Self {
            cells,
            odometer_m,
            place_m,
        }
    }
}

/// Returns a knot for each point that has a position.
pub(crate) fn single_knots(track: &[TrackPoint]) -> Vec<Knot> {
    let knot = |(i, point): (usize, &TrackPoint)| {
        let (latitude_deg, longitude_deg) = point.position?;
        let place_m = earth_centred(latitude_deg, longitude_deg);
        Some(Knot::new(i..i + 1, point.odometer_m, place_m))
    };
    track.iter().enumerate().filter_map(knot).collect()
}

/// Returns the knots of a run.
pub(crate) fn knots_of_run(cells: &[RunCell]) -> Vec<Knot> {
    let mut knots = Vec::with_capacity(cells.len() / 7 + 64);
    let mut begin = 0;
    while begin < cells.len() {
        if cells[begin].position.is_none() {
            begin += 1;
            continue;
        }
        let end = end_of_group(cells, begin);
        let is_inside = begin > 0 && goes_on(cells, begin) && goes_on(cells, end);
        let group = is_inside.then(|| mean(cells, begin..end)).flatten();
        match group {
            Some(knot) => knots.push(knot),
            None => knots.extend(cells_of(cells, begin..end)),
        }
        begin = end;
    }
    knots
}

/// Returns a knot for each of these cells, which have positions.
pub(crate) fn cells_of(cells: &[RunCell], range: Range<usize>) -> impl Iterator<Item = Knot> {
    range.filter_map(|i| {
        let (latitude_deg, longitude_deg) = cells[i].position?;
        let place_m = earth_centred(latitude_deg, longitude_deg);
        Some(Knot::new(i..i + 1, cells[i].distance_m, place_m))
    })
}

/// Returns true if a cell has a position and follows the one before it.
fn goes_on(cells: &[RunCell], i: usize) -> bool {
    let (before, Some(cell)) = (&cells[i - 1], cells.get(i)) else {
        return false;
    };
    before.position.is_some()
        && cell.position.is_some()
        && cell.distance_m - before.distance_m <= JOIN_LIMIT_M
}

fn end_of_group(cells: &[RunCell], begin: usize) -> usize {
    let limit_m = cells[begin].distance_m + KNOT_M;
    let mut end = begin + 1;
    while goes_on(cells, end) && cells[end].distance_m < limit_m {
        end += 1;
    }
    end
}

/// Returns the knot of these cells; `None` if a position is not near the line between the first and
/// the last.
fn mean(cells: &[RunCell], range: Range<usize>) -> Option<Knot> {
    let group = &cells[range.clone()];
    let (first, last) = (&group[0], &group[group.len() - 1]);
    let (latitude_deg, longitude_deg) = first.position?;
    // Relative to the first, so that the date line is no step.
    let from_first = |cell: &RunCell| {
        let at = cell.position?;
        let east = at.1 - longitude_deg;
        let east = if east.abs() > 180.0 {
            east - 360.0_f64.copysign(east)
        } else {
            east
        };
        Some([at.0 - latitude_deg, east])
    };
    let chord = from_first(last)?;
    let length_m = (last.distance_m - first.distance_m).max(f64::MIN_POSITIVE);
    let stray_deg = STRAY_M / DEGREE_M;
    let limit_deg = [stray_deg, stray_deg / latitude_deg.to_radians().cos()];
    let (mut sum, mut driven_m) = ([0.0; 2], 0.0);
    for cell in group {
        let at = from_first(cell)?;
        let along_m = cell.distance_m - first.distance_m;
        let part = along_m / length_m;
        for axis in 0..2 {
            if (at[axis] - part * chord[axis]).abs() > limit_deg[axis] {
                return None;
            }
            sum[axis] += at[axis];
        }
        driven_m += along_m;
    }
    let share = 1.0 / group.len() as f64;
    let place_m = earth_centred(
        latitude_deg + share * sum[0],
        longitude_deg + share * sum[1],
    );
    Some(Knot::new(
        range,
        first.distance_m + share * driven_m,
        place_m,
    ))
}
