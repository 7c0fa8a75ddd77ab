//! Ways with a spatial index of their segments.

use super::course::{CourseRelation, heading};
use super::grid::GRID_M;
use super::joins::Joins;
use super::plane::LocalPlane;
use super::road_index::{RoadIndex, Surroundings};
use super::road_line::{COURSE_REACH_M, Foot, RoadLine};
use super::way_name::WayName;
use std::ops::Range;

/// One way.
#[derive(Debug)]
pub struct Way {
    /// Name of the way; `None` for a single road.
    pub name: Option<WayName>,
    /// Its line.
    pub line: RoadLine,
    /// Index of its first cell in the network.
    first_cell: usize,
}

/// Ways with an index of their segments.
#[derive(Debug)]
pub(crate) struct WayIndex {
    ways: Vec<Way>,
    index: RoadIndex,
    cells: usize,
}

/// A candidate pass for a position.
#[derive(Clone, Copy, Debug)]
pub(crate) struct WayCandidate {
    pub way: usize,
    pub foot: Foot,
    /// True if the course only fits a vehicle that turns off, or onto the way, here.
    pub turning: bool,
}

/// A way, with a position and a course in its plane.
type ProjectedPosition = (usize, Option<[f64; 2]>, Option<[f64; 2]>);

impl WayIndex {
    /// Creates an index of these ways, in their order.
    pub(crate) fn new(ways: Vec<(Option<WayName>, RoadLine)>) -> Self {
        let mut cells = 0;
        let ways: Vec<Way> = ways
            .into_iter()
            .map(|(name, line)| {
                let first_cell = cells;
                let numbers = line.cell_numbers();
                cells += usize::try_from(numbers.end() - numbers.start() + 1).unwrap_or(0);
                Way {
                    name,
                    line,
                    first_cell,
                }
            })
            .collect();
        Self {
            index: RoadIndex::of(ways.iter().map(|way| &way.line)),
            ways,
            cells,
        }
    }

    /// Returns the ways, in the order of their names.
    pub(crate) fn ways(&self) -> &[Way] {
        &self.ways
    }

    /// Returns the number of cells of all ways.
    pub(crate) const fn cells(&self) -> usize {
        self.cells
    }

    /// Returns the indices of the cells of a way in the network.
    pub(crate) fn cells_of(&self, way: usize) -> Range<usize> {
        let end = self
            .ways
            .get(way + 1)
            .map_or(self.cells, |next| next.first_cell);
        self.ways[way].first_cell..end
    }

    /// Returns the distance of the first cell along its way, over 2.5 m.
    pub(crate) fn first_number(&self, way: usize) -> i64 {
        *self.ways[way].line.cell_numbers().start()
    }

    /// Moves a projection beyond an end of its way onto the end, if another way continues there.
    fn within(&self, joins: &Joins, way: usize, mut foot: Foot) -> Foot {
        let line = &self.ways[way].line;
        let within_m = foot.distance_m.clamp(line.start_m(), line.end_m());
        let beyond_m = foot.distance_m - within_m;
        if beyond_m != 0.0 && joins.is_near(way, within_m, COURSE_REACH_M) {
            foot.distance_m = within_m;
            foot.lateral_m2 += beyond_m * beyond_m;
        }
        foot
    }

    /// Appends to `along` the passes of ways near a place (earth-centred) in the same direction:
    /// the nearest point of each, in the order of ways and distances. `course` gives the direction
    /// of the vehicle in the plane of a way. Returns true if a way has the opposite direction here.
    pub(crate) fn nearby(
        &self,
        joins: &Joins,
        surroundings: &mut Surroundings,
        place_m: [f64; 3],
        course: impl Fn(&LocalPlane) -> Option<[f64; 2]>,
        along: &mut Vec<WayCandidate>,
    ) -> bool {
        let mut opposite = false;
        let mut last = None;
        // The current way, with the position and the course in its plane.
        let mut view: Option<ProjectedPosition> = None;
        for piece in self.index.near(surroundings, place_m) {
            let line = &self.ways[piece.way].line;
            let (_, point, course) = match view {
                Some(seen @ (way, ..)) if way == piece.way => seen,
                _ => *view.insert((piece.way, line.plane().point(place_m), course(line.plane()))),
            };
            let Some(point) = point else {
                continue;
            };
            for i in piece.segments.clone() {
                let Some(foot) = line.project(i, point) else {
                    continue;
                };
                let foot = self.within(joins, piece.way, foot);
                let heading = course.map(|course| heading(line.course_of(&foot), course));
                let turning = match heading {
                    None | Some(CourseRelation::Along) => false,
                    Some(CourseRelation::Opposite) => {
                        opposite = true;
                        continue;
                    }
                    // At a join one end of a chord is on the previous or the next way.
                    Some(CourseRelation::AcrossForward)
                        if joins.is_near(piece.way, foot.distance_m, COURSE_REACH_M) =>
                    {
                        true
                    }
                    Some(_) => continue,
                };
                let candidate = WayCandidate {
                    way: piece.way,
                    foot,
                    turning,
                };
                // Neighbouring segments are one pass of the road; its nearest point counts.
                let same_pass = last == Some((piece.way, i.wrapping_sub(1)));
                last = Some((piece.way, i));
                match along.last_mut() {
                    Some(best) if same_pass => {
                        if foot.lateral_m2 < best.foot.lateral_m2 {
                            *best = candidate;
                        }
                    }
                    _ => along.push(candidate),
                }
            }
        }
        opposite
    }
}

impl Way {
    /// Returns the distances of the cells along the way, m.
    pub fn cell_distances(&self) -> impl Iterator<Item = f64> {
        self.line
            .cell_numbers()
            .map(|number| number as f64 * GRID_M)
    }
}
