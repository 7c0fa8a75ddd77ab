//! A recorded drive through the estimator, its files reached by semihosting.

use crate::exchange::cell;
use crate::exchange::frame::{self, FRAME_BYTES};
use crate::exchange::vehicle::{self, VEHICLE_BYTES};
use crate::exchange::{CELLS_FILE, DRIVE_FILE};
use core::fmt;
use estimator_core::{Cell, Estimator, ParameterError, Tuning, Uncertain};
use semihosting::fs::File;
use semihosting::io::{self, Read, Write};
use static_cell::StaticCell;

/// Frames fetched at once: each fetch stops the processor for the debugger.
const BLOCK_FRAMES: usize = 128;

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
    /// The drive cannot be read.
    Read(io::Error),
    /// The cells cannot be written.
    Write(io::Error),
    /// The drive does not begin with the header of a vehicle.
    Header,
    /// The record of this frame, from 1, is none.
    Frame(u32),
    /// No vehicle has such a parameter.
    Vehicle(ParameterError),
}

/// Feeds every frame of [`DRIVE_FILE`] to the estimator and writes the cells to [`CELLS_FILE`].
///
/// # Errors
/// An unusable drive, or no place for the cells.
///
/// # Panics
/// When called twice: there is one estimator.
pub fn run() -> Result<Summary, Problem> {
    let mut drive = File::open(DRIVE_FILE).map_err(Problem::Read)?;
    let mut header = [0; VEHICLE_BYTES];
    let filled = fill(&mut drive, &mut header)?;
    let vehicle = vehicle::decode(&header[..filled]).ok_or(Problem::Header)?;
    let estimator = Estimator::new(vehicle, Tuning::default()).map_err(Problem::Vehicle)?;
    let estimator = ESTIMATOR.init(estimator);

    let mut cells = File::create(CELLS_FILE).map_err(Problem::Write)?;
    let mut summary = Summary::default();
    let mut block = [0; BLOCK_FRAMES * FRAME_BYTES];
    loop {
        let filled = fill(&mut drive, &mut block)?;
        if filled == 0 {
            break;
        }
        for record in block[..filled].chunks(FRAME_BYTES) {
            summary.frames += 1;
            let (time, frame) = frame::decode(record).ok_or(Problem::Frame(summary.frames))?;
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
    Ok(summary)
}

/// Reads until the buffer is full or the file ends; returns how much was read.
fn fill(file: &mut File, buffer: &mut [u8]) -> Result<usize, Problem> {
    let mut filled = 0;
    while filled < buffer.len() {
        match file.read(&mut buffer[filled..]).map_err(Problem::Read)? {
            0 => break,
            count => filled += count,
        }
    }
    Ok(filled)
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
            Self::Read(error) => write!(f, "{DRIVE_FILE:?}: {error}"),
            Self::Write(error) => write!(f, "{CELLS_FILE:?}: {error}"),
            Self::Header => write!(f, "{DRIVE_FILE:?}: expected the header of a vehicle"),
            Self::Frame(number) => write!(f, "{DRIVE_FILE:?}: frame {number} is malformed"),
            Self::Vehicle(error) => write!(f, "{DRIVE_FILE:?}: {error}"),
        }
    }
}
