//! A block of a packed map: up to 128 cells of one way.

use super::block_cells::{
    ALTITUDE_CELLS, Altitudes, Cells, Grades, ParkedCells, ParkedGrades, SIGMA_CELLS,
};
use super::map_error::MapError;
use super::record::{Numbers, sized_content, sized_record};

/// Bytes before the points.
pub const HEADER: usize = 22;
/// Most cells of a block.
pub const MOST_CELLS: usize = 128;

/// Changes of place are multiples of ten of their unit in the file.
const PLACE_STEP: i32 = 10;
/// Half a turn, 10⁻⁷ degrees.
const HALF_TURN_E7: i32 = 1_800_000_000;

/// A block: up to 128 cells of one way without a gap.
#[derive(Clone, Copy, Debug)]
pub struct Block<'m> {
    /// Its offset.
    pub offset: u32,
    /// Offset of its way.
    pub way: u32,
    /// Number of its first cell.
    pub first_cell: i32,
    /// Number of its cells.
    pub count: u8,
    /// Offset of what follows it: the next block of the way, or its end.
    pub next: u32,
    has_altitude: bool,
    start: MapPoint,
    points: u16,
    body: Numbers<'m>,
}

/// A point of the plan view.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MapPoint {
    /// Number of the cell that ends here.
    pub cell: i32,
    /// Latitude, 10⁻⁷ degrees.
    pub latitude_e7: i32,
    /// Longitude, 10⁻⁷ degrees.
    pub longitude_e7: i32,
}

impl<'m> Block<'m> {
    /// Reads the header of the block at an offset, and checks the block.
    pub(super) fn read(bytes: &'m [u8], offset: u32) -> Result<Self, MapError> {
        Self::of_content(sized_record(bytes, offset)?, offset)
    }

    /// Reads the block at the start of these bytes, which was checked before.
    pub(super) fn read_again(bytes: &'m [u8]) -> Result<Self, MapError> {
        Self::of_content(sized_content(bytes)?, 0)
    }

    fn of_content(content: &'m [u8], offset: u32) -> Result<Self, MapError> {
        let mut numbers = Numbers(content);
        let length = numbers.u16()?;
        let count = numbers.u8()?;
        let has_altitude = match numbers.u8()? {
            0 => false,
            1 => true,
            _ => return Err(MapError::Content),
        };
        let way = numbers.u32()?;
        let first_cell = numbers.i32()?;
        let start = MapPoint {
            cell: first_cell,
            latitude_e7: numbers.i32()?,
            longitude_e7: numbers.i32()?,
        };
        let points = numbers.u16()?;
        let is_possible = (1..=MOST_CELLS).contains(&usize::from(count))
            && first_cell.checked_add(count.into()).is_some()
            && start.is_possible();
        if !is_possible {
            return Err(MapError::Content);
        }
        Ok(Self {
            offset,
            way,
            first_cell,
            count,
            next: offset.checked_add(length.into()).ok_or(MapError::Content)?,
            has_altitude,
            start,
            points,
            body: numbers,
        })
    }

    /// Returns the number of its last cell.
    #[must_use]
    pub fn last_cell(&self) -> i32 {
        self.first_cell + i32::from(self.count) - 1
    }

    /// Returns the points of its plan view. The last one is at its last cell, or at the first cell
    /// of the next block if there is no gap between.
    #[must_use]
    pub fn points(&self) -> Points<'m> {
        Points {
            next: Some(self.start),
            left: self.points,
            numbers: self.body,
        }
    }

    /// Returns its cells.
    ///
    /// # Errors
    /// Returns an error if the content cannot be.
    pub fn cells(&self) -> Result<Cells<'m>, MapError> {
        let (altitudes, grades) = self.parts()?;
        let altitude = if self.has_altitude {
            Some(Altitudes::read(altitudes, self.count.into())?)
        } else {
            None
        };
        Ok(Cells::begin(grades, altitude))
    }

    /// Returns the grades of its cells: a fraction of the work for [`cells`](Self::cells).
    pub(super) fn grades(&self) -> Result<Grades<'m>, MapError> {
        self.parts().map(|(_, grades)| grades)
    }

    /// Returns the cells from where they were parked in this block.
    pub(super) fn cells_from(&self, parked: &ParkedCells) -> Option<Cells<'m>> {
        Cells::resume(self.grades_from(&parked.grades)?, self.body, parked)
    }

    /// Returns the grades from where they were parked in this block.
    pub(super) fn grades_from(&self, parked: &ParkedGrades) -> Option<Grades<'m>> {
        Grades::resume(self.first_cell, self.count, self.body, parked)
    }

    /// Returns where the altitudes begin, and the grades.
    fn parts(&self) -> Result<(Numbers<'m>, Grades<'m>), MapError> {
        let mut numbers = self.body;
        for _ in 0..self.points {
            skip_point(&mut numbers)?;
        }
        let count = usize::from(self.count);
        let altitudes = numbers;
        if self.has_altitude {
            for _ in 0..=(count - 1).div_ceil(ALTITUDE_CELLS) {
                numbers.varint::<i32>()?;
            }
        }
        let runs = numbers;
        let mut covered = 0_usize;
        while covered < count {
            numbers.varint::<u32>()?;
            covered += usize::from(numbers.varint::<u16>()?.max(1));
        }
        let sigmas = numbers;
        numbers.bytes(count.div_ceil(SIGMA_CELLS))?;
        let grades = Grades::begin(self.first_cell, self.count, numbers, sigmas, runs);
        Ok((altitudes, grades))
    }
}

impl MapPoint {
    /// Returns the latitude and the longitude, degrees.
    #[must_use]
    pub fn position_deg(&self) -> (f64, f64) {
        let degrees = |angle_e7: i32| f64::from(angle_e7) / 1e7;
        (degrees(self.latitude_e7), degrees(self.longitude_e7))
    }

    fn is_possible(&self) -> bool {
        (-HALF_TURN_E7 / 2..=HALF_TURN_E7 / 2).contains(&self.latitude_e7)
            && (-HALF_TURN_E7..=HALF_TURN_E7).contains(&self.longitude_e7)
    }

    /// Returns the point that follows by these changes.
    fn followed_by(&self, cells: u16, latitude: i32, longitude: i32) -> Option<Self> {
        let moved = |from: i32, by: i32| from.checked_add(by.checked_mul(PLACE_STEP)?);
        let longitude_e7 = match moved(self.longitude_e7, longitude)? {
            east @ HALF_TURN_E7.. => east - HALF_TURN_E7 - HALF_TURN_E7,
            west if west < -HALF_TURN_E7 => west + HALF_TURN_E7 + HALF_TURN_E7,
            other => other,
        };
        let point = Self {
            cell: self.cell.checked_add(cells.into())?,
            latitude_e7: moved(self.latitude_e7, latitude)?,
            longitude_e7,
        };
        point.is_possible().then_some(point)
    }
}

/// Points of a plan view. Ends early where the content cannot be.
#[derive(Clone, Debug)]
pub struct Points<'m> {
    next: Option<MapPoint>,
    left: u16,
    numbers: Numbers<'m>,
}

impl Iterator for Points<'_> {
    type Item = MapPoint;

    fn next(&mut self) -> Option<MapPoint> {
        let point = self.next.take()?;
        if self.left > 0 {
            self.left -= 1;
            self.next =
                skip_point(&mut self.numbers)
                    .ok()
                    .and_then(|(cells, latitude, longitude)| {
                        point.followed_by(cells, latitude, longitude)
                    });
        }
        Some(point)
    }
}

#[inline(never)] // Reading numbers is long, and called from several places.
fn skip_point(numbers: &mut Numbers<'_>) -> Result<(u16, i32, i32), MapError> {
    Ok((numbers.varint()?, numbers.varint()?, numbers.varint()?))
}
