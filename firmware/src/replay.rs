//! A recorded drive through the estimator, its files reached by semihosting.

use crate::exchange::CELLS_FILE;
use crate::exchange::cell;
use crate::recorded::{Recorded, Unusable};
use core::fmt;
use estimator_core::{Cell, Estimator, Tuning, Uncertain};
use semihosting::fs::File;
use semihosting::io::{self, Write};
use static_cell::StaticCell;

/// Too large for a controller's stack, and in `.bss` its size can be read off the image.
static ESTIMATOR: StaticCell<Estimator<f32>> = StaticCell::new();

/// What a replay came to; shown as one line.
#[derive(Clone, Copy, Debug, Default)]
pub struct Summary {
    frames: u32,
    cells: u32,
    last_grade_percent: Option<Uncertain>,
}

/// Why a replay ended early.
#[derive(Debug)]
pub enum Problem {
    /// The drive cannot be used.
    Drive(Unusable),
    /// The cells cannot be written.
    Write(io::Error),
}

impl From<Unusable> for Problem {
    fn from(unusable: Unusable) -> Self {
        Self::Drive(unusable)
    }
}

/// Feeds every frame of the recorded drive to the estimator and writes the cells to [`CELLS_FILE`].
///
/// # Errors
/// An unusable drive, or no place for the cells.
///
/// # Panics
/// When called twice: there is one estimator.
pub fn run() -> Result<Summary, Problem> {
    let (vehicle, mut drive) = Recorded::open()?;
    let estimator = Estimator::new(vehicle, Tuning::default()).map_err(Unusable::Vehicle)?;
    let estimator = ESTIMATOR.init(estimator);

    let mut cells = File::create(CELLS_FILE).map_err(Problem::Write)?;
    let mut summary = Summary::default();
    loop {
        let block = drive.next_block()?;
        if block.len() == 0 {
            break;
        }
        for frame in block {
            let (time, frame) = frame?;
            estimator.on_frame(time, &frame);
            while estimator.step().is_some() {
                while let Some(cell) = estimator.next_cell() {
                    summary.write(&mut cells, &cell)?;
                }
            }
        }
    }
    while let Some(cell) = estimator.drain_cell() {
        summary.write(&mut cells, &cell)?;
    }
    summary.frames = drive.frames();
    Ok(summary)
}

impl Summary {
    /// Writes one more cell.
    fn write(&mut self, file: &mut File, cell: &Cell) -> Result<(), Problem> {
        self.cells += 1;
        self.last_grade_percent = Some(cell.lagged_grade_percent);
        file.write_all(&cell::encode(cell)).map_err(Problem::Write)
    }
}

impl fmt::Display for Summary {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} frames, {} cells", self.frames, self.cells)?;
        match self.last_grade_percent {
            Some(grade) => write!(f, ", last grade {:.3} ± {:.3} %", grade.value, grade.sigma),
            None => Ok(()),
        }
    }
}

impl fmt::Display for Problem {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Drive(unusable) => write!(f, "{unusable}"),
            Self::Write(error) => write!(f, "{CELLS_FILE:?}: {error}"),
        }
    }
}
