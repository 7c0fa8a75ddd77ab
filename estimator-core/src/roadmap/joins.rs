//! The joins of a packed map.

use super::join::Join;
use super::map_error::MapError;
use super::packed_map::{MapWay, PackedMap};
use super::record::{Numbers, record};

/// Bytes of a join.
pub const JOIN: usize = 20;

impl<'m> PackedMap<'m> {
    /// Returns the joins at which a way is left, in the order of their cells. After an error there
    /// are no more.
    #[must_use]
    pub const fn joins(&self, way: &MapWay<'m>) -> Joins<'m> {
        Joins {
            map: *self,
            first: way.first_join,
            next: 0,
            count: way.joins,
        }
    }

    /// Returns the joins of a way from a cell on, found by bisection.
    #[must_use]
    pub fn joins_from(&self, way: &MapWay<'m>, cell: f32) -> Joins<'m> {
        let mut joins = self.joins(way);
        let (mut low, mut high) = (0, way.joins);
        while low < high {
            let middle = low + (high - low) / 2;
            match joins.at(middle) {
                Ok(join) if (join.at_cell as f32) < cell => low = middle + 1,
                _ => high = middle,
            }
        }
        joins.next = low;
        joins
    }
}

/// The joins at which a way is left.
#[derive(Clone, Debug)]
pub struct Joins<'m> {
    map: PackedMap<'m>,
    first: u32,
    next: u32,
    count: u32,
}

/// The joins at which a way is left, without their map.
#[derive(Clone, Copy, Debug)]
pub(super) struct ParkedJoins {
    first: u32,
    next: u32,
    count: u32,
}

impl ParkedJoins {
    /// Comes back to the map, which has not changed.
    pub(super) const fn resume<'m>(&self, map: &PackedMap<'m>) -> Joins<'m> {
        Joins {
            map: *map,
            first: self.first,
            next: self.next,
            count: self.count,
        }
    }
}

impl Iterator for Joins<'_> {
    type Item = Result<Join, MapError>;

    fn next(&mut self) -> Option<Self::Item> {
        // A way of a memory may have made room since.
        while self.map.memory.is_some() && self.next < self.count && self.at(self.next).is_err() {
            self.next += 1;
        }
        if self.next >= self.count {
            return None;
        }
        let join = self.at(self.next);
        self.next = if join.is_ok() {
            self.next + 1
        } else {
            self.count
        };
        Some(join)
    }
}

impl Joins<'_> {
    /// Leaves the map.
    pub(super) const fn park(&self) -> ParkedJoins {
        ParkedJoins {
            first: self.first,
            next: self.next,
            count: self.count,
        }
    }

    fn at(&self, index: u32) -> Result<Join, MapError> {
        if let Some(memory) = &self.map.memory {
            return memory.join(self.first + index);
        }
        let offset = u32::try_from(JOIN)
            .ok()
            .and_then(|length| self.first.checked_add(index.checked_mul(length)?))
            .ok_or(MapError::Content)?;
        let mut numbers = Numbers(record(self.map.bytes, offset, JOIN)?);
        Ok(Join {
            at_cell: numbers.i32()?,
            to_way: numbers.u32()?,
            to_cell: numbers.i32()?,
            to_block: numbers.u32()?,
        })
    }
}
