//! The cells of a block of a packed map, read one after the other.

use super::map_error::MapError;
use super::record::Numbers;

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

/// Grades without the bytes of their block. Offsets are counted from its end.
#[derive(Clone, Copy, Debug)]
pub(super) struct ParkedGrades {
    grade: i32,
    difference: i32,
    runs: u32,
    runs_left: u16,
    numbers: u16,
    sigmas: u16,
    runs_numbers: u16,
    done: u8,
}

impl<'m> Grades<'m> {
    /// Begins with the first cell: the grades, the sigmas and the numbers of runs begin here.
    pub(super) const fn begin(
        first_cell: i32,
        count: u8,
        numbers: Numbers<'m>,
        sigmas: Numbers<'m>,
        runs: Numbers<'m>,
    ) -> Self {
        Self {
            first_cell,
            count: count as usize,
            done: 0,
            grade: 0,
            difference: 0,
            numbers,
            sigmas: sigmas.0,
            runs: Runs {
                runs: 0,
                left: 0,
                numbers: runs,
            },
        }
    }

    /// Goes on where the grades were parked. `body` are the bytes of the block, to their end.
    pub(super) fn resume(
        first_cell: i32,
        count: u8,
        body: Numbers<'m>,
        parked: &ParkedGrades,
    ) -> Option<Self> {
        let runs = body.last(parked.runs_numbers)?;
        let (numbers, sigmas) = (body.last(parked.numbers)?, body.last(parked.sigmas)?);
        Some(Self {
            done: parked.done.into(),
            grade: parked.grade,
            difference: parked.difference,
            runs: Runs {
                runs: parked.runs,
                left: parked.runs_left,
                numbers: runs,
            },
            ..Self::begin(first_cell, count, numbers, sigmas, runs)
        })
    }

    /// Leaves the bytes of the block.
    pub(super) const fn park(&self) -> ParkedGrades {
        ParkedGrades {
            grade: self.grade,
            difference: self.difference,
            runs: self.runs.runs,
            runs_left: self.runs.left,
            numbers: self.numbers.0.len() as u16,
            sigmas: self.sigmas.len() as u16,
            runs_numbers: self.runs.numbers.0.len() as u16,
            done: self.done as u8,
        }
    }
}

/// Cells of a block. Ends early where the content cannot be.
#[derive(Clone, Debug)]
pub struct Cells<'m> {
    grades: Grades<'m>,
    altitude: Option<Altitudes<'m>>,
}

/// Cells without the bytes of their block.
#[derive(Clone, Copy, Debug)]
pub(super) struct ParkedCells {
    pub(super) grades: ParkedGrades,
    altitude: Option<ParkedAltitudes>,
}

/// Altitudes without the bytes of their block. The offset is counted from its end.
#[derive(Clone, Copy, Debug)]
struct ParkedAltitudes {
    climbed: i32,
    correction: i32,
    corrections: u16,
}

impl<'m> Cells<'m> {
    /// Leaves the bytes of the block.
    pub(super) fn park(&self) -> ParkedCells {
        ParkedCells {
            grades: self.grades.park(),
            altitude: self.altitude.as_ref().map(|altitude| ParkedAltitudes {
                climbed: altitude.climbed,
                correction: altitude.correction,
                corrections: altitude.corrections.0.len() as u16,
            }),
        }
    }

    /// Goes on where the cells were parked. `body` are the bytes of the block, to their end.
    pub(super) fn resume(
        grades: Grades<'m>,
        body: Numbers<'m>,
        parked: &ParkedCells,
    ) -> Option<Self> {
        let altitude = match &parked.altitude {
            Some(altitude) => Some(Altitudes {
                count: grades.count,
                climbed: altitude.climbed,
                correction: altitude.correction,
                corrections: body.last(altitude.corrections)?,
            }),
            None => None,
        };
        Some(Self { grades, altitude })
    }

    /// Begins with the first cell.
    pub(super) const fn begin(grades: Grades<'m>, altitude: Option<Altitudes<'m>>) -> Self {
        Self { grades, altitude }
    }
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
pub(super) struct Altitudes<'m> {
    /// Number of cells of the block.
    count: usize,
    /// Altitude by the grades and by the corrections of earlier stretches.
    climbed: i32,
    /// Correction at the end of this stretch.
    correction: i32,
    corrections: Numbers<'m>,
}

impl<'m> Altitudes<'m> {
    /// Begins with the first cell.
    pub(super) fn read(mut numbers: Numbers<'m>, count: usize) -> Result<Self, MapError> {
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
    use super::SIGMA_CODES_PER_OCTAVE;
    use super::power_of_two;

    #[test]
    fn a_power_of_two_is_that_of_the_library() {
        for code in 0..=u8::MAX {
            let expected = libm::exp2f(f32::from(code) / SIGMA_CODES_PER_OCTAVE);
            assert_eq!(power_of_two(code), expected, "{code}");
        }
    }
}
