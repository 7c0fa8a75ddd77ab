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
            cursor: JoinCursor {
                first: way.first_join,
                next: 0,
                count: way.joins,
            },
        }
    }

    /// Returns the joins of a way from a cell on, found by bisection.
    #[must_use]
    pub fn joins_from(&self, way: &MapWay<'m>, cell: f32) -> Joins<'m> {
        let mut joins = self.joins(way);
        let (mut low, mut high) = (0, way.joins);
        while low < high {
            let middle = low + (high - low) / 2;
            match self.join(way.first_join, middle) {
                Ok(join) if (join.at_cell as f32) < cell => low = middle + 1,
                _ => high = middle,
            }
        }
        joins.cursor.next = low;
        joins
    }

    /// Returns a join of a way, given by the first one of the way.
    fn join(&self, first: u32, index: u32) -> Result<Join, MapError> {
        if let Some(memory) = &self.memory {
            return memory.join(first + index);
        }
        let offset = u32::try_from(JOIN)
            .ok()
            .and_then(|length| first.checked_add(index.checked_mul(length)?))
            .ok_or(MapError::Content)?;
        let mut numbers = Numbers(record(self.bytes, offset, JOIN)?);
        Ok(Join {
            at_cell: numbers.i32()?,
            to_way: numbers.u32()?,
            to_cell: numbers.i32()?,
            to_block: numbers.u32()?,
        })
    }
}

/// The joins at which a way is left.
#[derive(Clone, Debug)]
pub struct Joins<'m> {
    map: PackedMap<'m>,
    /// Where it is among them.
    pub(super) cursor: JoinCursor,
}

impl Iterator for Joins<'_> {
    type Item = Result<Join, MapError>;

    fn next(&mut self) -> Option<Self::Item> {
        self.cursor.next(&self.map)
    }
}

/// A position among the joins of a way, without their map.
#[derive(Clone, Copy, Debug)]
pub(super) struct JoinCursor {
    first: u32,
    next: u32,
    count: u32,
}

impl JoinCursor {
    /// Returns the next join. After an error there are no more.
    pub(super) fn next(&mut self, map: &PackedMap<'_>) -> Option<Result<Join, MapError>> {
        // A way of a memory may have made room since.
        while map.memory.is_some()
            && self.next < self.count
            && map.join(self.first, self.next).is_err()
        {
            self.next += 1;
        }
        if self.next >= self.count {
            return None;
        }
        let join = map.join(self.first, self.next);
        self.next = if join.is_ok() {
            self.next + 1
        } else {
            self.count
        };
        Some(join)
    }
}
