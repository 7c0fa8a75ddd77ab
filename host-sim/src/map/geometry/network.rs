//! The roads of a map: ways, each a line in one direction of travel, and their joins. A single road
//! is a network of one way without a name.

use super::find_joins::find_joins;
use super::joins::Joins;
use super::plane::LocalPlane;
use super::road_index::Surroundings;
use super::road_line::RoadLine;
use super::structure::Structure;
use super::way_index::{Way, WayCandidate, WayIndex};
use super::way_name::WayName;
use std::collections::BTreeMap;
use std::ops::Range;

/// Ways and their joins.
#[derive(Debug)]
pub struct Network {
    ways: WayIndex,
    joins: Joins,
    /// Structures of ways, by name.
    structures: BTreeMap<String, Structure>,
}

impl From<RoadLine> for Network {
    /// Creates the network of a single road. Where the road meets itself, the odometer decides.
    fn from(line: RoadLine) -> Self {
        Self {
            ways: WayIndex::new(vec![(None, line)]),
            joins: Joins::default(),
            structures: BTreeMap::new(),
        }
    }
}

impl Network {
    /// Creates a network of these ways. Names must be unique; the order is irrelevant.
    #[must_use]
    pub fn new(mut ways: Vec<(WayName, RoadLine)>) -> Self {
        ways.sort_by(|a, b| a.0.cmp(&b.0));
        let ways = ways.into_iter().map(|(name, line)| (Some(name), line));
        let ways = WayIndex::new(ways.collect());
        Self {
            joins: find_joins(&ways),
            ways,
            structures: BTreeMap::new(),
        }
    }

    /// Sets the structures that carry its ways, by name of the way.
    #[must_use]
    pub fn with_structures(self, structures: BTreeMap<String, Structure>) -> Self {
        Self { structures, ..self }
    }

    /// Returns the structure that carries a way; `None` on the ground, or where the file of the
    /// network tells none.
    #[must_use]
    pub fn structure(&self, way: &str) -> Option<Structure> {
        self.structures.get(way).copied()
    }

    /// Returns its ways, in the order of their names.
    #[must_use]
    pub fn ways(&self) -> &[Way] {
        self.ways.ways()
    }

    /// Returns the number of cells on all its ways.
    #[must_use]
    pub const fn cells(&self) -> usize {
        self.ways.cells()
    }

    /// Returns the indices of the cells of a way in the network.
    pub(crate) fn cells_of(&self, way: usize) -> Range<usize> {
        self.ways.cells_of(way)
    }

    /// Returns the distance of the first cell along its way, over 2.5 m.
    pub(crate) fn first_number(&self, way: usize) -> i64 {
        self.ways.first_number(way)
    }

    pub(crate) const fn joins(&self) -> &Joins {
        &self.joins
    }

    /// Finds passes near a place; see [`WayIndex::nearby`].
    pub(crate) fn nearby(
        &self,
        surroundings: &mut Surroundings,
        place_m: [f64; 3],
        course: impl Fn(&LocalPlane) -> Option<[f64; 2]>,
        along: &mut Vec<WayCandidate>,
    ) -> bool {
        let Self { ways, joins, .. } = self;
        ways.nearby(joins, surroundings, place_m, course, along)
    }
}
