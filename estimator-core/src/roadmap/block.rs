//! A block of a packed map: up to 128 cells of one way.

use super::map_error::MapError;
use super::record::{Numbers, sized_content, sized_record};

/// Bytes before the points.
pub const HEADER: usize = 22;
/// Most cells of a block.
pub const MOST_CELLS: usize = 128;
/// Cells with one sigma.
pub const SIGMA_CELLS: usize = 16;
/// Cells with one correction of the climb.
pub const ALTITUDE_CELLS: usize = 32;
/// Grade of one unit, 1/%: the units of two neighbouring cells, added, are their climb in 1/16 mm.
pub const GRADE_UNITS_PER_PERCENT: f32 = 200.0;
/// Altitude units (1/16 mm) of one cm.
pub const ALTITUDE_UNITS_PER_CM: i32 = 160;
/// Sigma of code 0, %.
pub const SIGMA_UNIT_PERCENT: f32 = 0.001;
/// Codes in which the sigma doubles.
pub const SIGMA_CODES_PER_OCTAVE: f32 = 16.0;

/// Powers of two, of the sixteenths of an octave. A general power takes double precision, which a
/// controller has to emulate.
#[allow(clippy::excessive_precision)]
const SIXTEENTHS: [f32; 16] = [
    1.0,
    1.044_273_73,
    1.090_507_75,
    1.138_788_58,
    1.189_207_08,
    1.241_857_77,
    1.296_839_59,
    1.354_255_56,
    1.414_213_54,
    1.476_826_19,
    1.542_210_82,
    1.610_490_32,
    1.681_792_86,
    1.756_252_17,
    1.834_008_10,
    1.915_206_55,
];

/// Altitude units of one metre.
const ALTITUDE_UNITS_PER_M: f32 = 16_000.0;
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

/// A cell of a packed map.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MapCell {
    /// Its number: the distance along the way over 2.5 m.
    pub cell: i32,
    /// Grade in the direction of travel, %.
    pub grade_percent: f32,
    /// Standard deviation of the grade, %.
    pub grade_sigma_percent: f32,
    /// Altitude, m.
    pub altitude_m: Option<f32>,
    /// Number of runs.
    pub runs: u32,
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
        Ok(Cells { grades, altitude })
    }

    /// Returns the grades of its cells: a fraction of the work for [`cells`](Self::cells).
    pub(super) fn grades(&self) -> Result<Grades<'m>, MapError> {
        self.parts().map(|(_, grades)| grades)
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
        let sigmas = numbers.bytes(count.div_ceil(SIGMA_CELLS))?;
        let grades = Grades {
            first_cell: self.first_cell,
            count,
            done: 0,
            grade: 0,
            difference: 0,
            numbers,
            sigmas,
            runs: Runs {
                runs: 0,
                left: 0,
                numbers: runs,
            },
        };
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
        self.latitude_e7.abs() <= HALF_TURN_E7 / 2
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

fn skip_point(numbers: &mut Numbers<'_>) -> Result<(u16, i32, i32), MapError> {
    Ok((numbers.varint()?, numbers.varint()?, numbers.varint()?))
}

/// Grade of a cell.
#[derive(Clone, Copy, Debug)]
pub(super) struct CellGrade {
    /// Number of the cell.
    pub(super) cell: i32,
    /// Grade, in the unit of the file.
    units: i32,
    sigma_code: u8,
    /// Number of runs.
    pub(super) runs: u32,
}

impl CellGrade {
    /// Returns the grade, %.
    pub(super) fn grade_percent(&self) -> f32 {
        self.units as f32 / GRADE_UNITS_PER_PERCENT
    }

    /// Returns its standard deviation, %.
    pub(super) fn sigma_percent(&self) -> f32 {
        SIGMA_UNIT_PERCENT * power_of_two(self.sigma_code)
    }
}

/// Grades of the cells of a block. Ends early where the content cannot be.
#[derive(Clone, Debug)]
pub(super) struct Grades<'m> {
    first_cell: i32,
    count: usize,
    done: usize,
    grade: i32,
    difference: i32,
    numbers: Numbers<'m>,
    sigmas: &'m [u8],
    runs: Runs<'m>,
}

/// Cells of a block. Ends early where the content cannot be.
#[derive(Clone, Debug)]
pub struct Cells<'m> {
    grades: Grades<'m>,
    altitude: Option<Altitudes<'m>>,
}

impl Iterator for Cells<'_> {
    type Item = MapCell;

    fn next(&mut self) -> Option<MapCell> {
        let (index, before) = (self.grades.done, self.grades.grade);
        let grade = self.grades.next()?;
        let climb = before.checked_add(grade.units)?;
        let altitude_m = match &mut self.altitude {
            Some(altitude) => Some(altitude.at(index, climb)?),
            None => None,
        };
        Some(MapCell {
            cell: grade.cell,
            grade_percent: grade.grade_percent(),
            grade_sigma_percent: grade.sigma_percent(),
            altitude_m,
            runs: grade.runs,
        })
    }
}

impl Iterator for Grades<'_> {
    type Item = CellGrade;

    fn next(&mut self) -> Option<CellGrade> {
        if self.done >= self.count {
            return None;
        }
        self.advance()?;
        let index = self.done;
        self.done += 1;
        Some(CellGrade {
            cell: self.first_cell.checked_add(i32::try_from(index).ok()?)?,
            units: self.grade,
            sigma_code: *self.sigmas.get(index / SIGMA_CELLS)?,
            runs: self.runs.next()?,
        })
    }
}

impl Grades<'_> {
    fn advance(&mut self) -> Option<()> {
        let number: i32 = self.numbers.varint().ok()?;
        match self.done {
            0 => self.grade = number,
            _ => {
                self.difference = if self.done == 1 {
                    number
                } else {
                    self.difference.checked_add(number)?
                };
                self.grade = self.grade.checked_add(self.difference)?;
            }
        }
        Some(())
    }
}

/// Numbers of runs.
#[derive(Clone, Debug)]
struct Runs<'m> {
    runs: u32,
    left: u16,
    numbers: Numbers<'m>,
}

impl Runs<'_> {
    fn next(&mut self) -> Option<u32> {
        if self.left == 0 {
            self.runs = self.numbers.varint().ok()?;
            self.left = self.numbers.varint::<u16>().ok()?.max(1);
        }
        self.left -= 1;
        Some(self.runs)
    }
}

/// Altitudes, in 1/16 mm.
#[derive(Clone, Debug)]
struct Altitudes<'m> {
    /// Number of cells of the block.
    count: usize,
    /// Altitude by the grades and by the corrections of earlier stretches.
    climbed: i32,
    /// Correction at the end of this stretch.
    correction: i32,
    corrections: Numbers<'m>,
}

impl<'m> Altitudes<'m> {
    fn read(mut numbers: Numbers<'m>, count: usize) -> Result<Self, MapError> {
        let units = |cm: i32| {
            cm.checked_mul(ALTITUDE_UNITS_PER_CM)
                .ok_or(MapError::Content)
        };
        Ok(Self {
            count,
            climbed: units(numbers.varint()?)?,
            correction: 0,
            corrections: numbers,
        })
    }

    /// Returns the altitude at the cell with this index, m. Each index is given in turn. `climb` is
    /// the sum of the grades of the cell and of the one before.
    fn at(&mut self, index: usize, climb: i32) -> Option<f32> {
        let mut altitude = self.climbed;
        if index > 0 {
            let in_stretch = (index - 1) % ALTITUDE_CELLS;
            if in_stretch == 0 {
                self.climbed = self.climbed.checked_add(self.correction)?;
                let cm: i32 = self.corrections.varint().ok()?;
                self.correction = cm.checked_mul(ALTITUDE_UNITS_PER_CM)?;
            }
            let length = ALTITUDE_CELLS.min(self.count - (index - in_stretch));
            self.climbed = self.climbed.checked_add(climb)?;
            let part = i32::try_from(in_stretch + 1).ok()?;
            let part = self.correction.checked_mul(part)?;
            let part = part.checked_div_euclid(i32::try_from(length).ok()?)?;
            altitude = self.climbed.checked_add(part)?;
        }
        Some(altitude as f32 / ALTITUDE_UNITS_PER_M)
    }
}

/// Returns 2 to the power of a sixteenth of the code.
fn power_of_two(code: u8) -> f32 {
    let octaves = 1_u32 << (code / 16);
    SIXTEENTHS[usize::from(code % 16)] * octaves as f32
}

#[cfg(test)]
mod tests {
    use super::{SIGMA_CODES_PER_OCTAVE, power_of_two};

    #[test]
    fn a_power_of_two_is_that_of_the_library() {
        for code in 0..=u8::MAX {
            let expected = libm::exp2f(f32::from(code) / SIGMA_CODES_PER_OCTAVE);
            assert_eq!(power_of_two(code), expected, "{code}");
        }
    }
}
