//! Runs a recorded drive through the estimator. Its files are read and written by semihosting.

use crate::exchange::frame::RecordedFrame;
use crate::exchange::{CELLS_FILE, ON_MAP_FILE, cell, on_map};
use crate::map_region;
use crate::on_map::OnMap;
use crate::recorded::{Recorded, Unusable};
use core::ffi::CStr;
use core::fmt;
use estimator_core::{Cell, Estimator, Step, Tuning, Uncertain};
use semihosting::fs::File;
use semihosting::io::{self, Write};
use static_cell::StaticCell;

/// Static, since it is too large for a controller's stack. Its size can be read from the image.
static ESTIMATOR: StaticCell<Estimator<f32>> = StaticCell::new();
static ON_MAP: StaticCell<OnMap<'static>> = StaticCell::new();

/// Number of cells from one log of the estimate to the next.
const CELLS_PER_KM: u32 = 400;

/// Why a replay ended early.
#[derive(Debug)]
pub enum ReplayError {
    /// The drive cannot be used.
    Drive(Unusable),
    /// A file cannot be written.
    Write(&'static CStr, io::Error),
}

impl From<Unusable> for ReplayError {
    fn from(unusable: Unusable) -> Self {
        Self::Drive(unusable)
    }
}

/// Feeds every frame of the recorded drive to the estimator and writes the cells to [`CELLS_FILE`].
/// With a map in flash, writes its part of each step to [`ON_MAP_FILE`]. Logs the estimate each
/// kilometre.
///
/// # Errors
/// The drive is unusable, or a file cannot be written.
///
/// # Panics
/// Panics when called twice: there is one estimator.
pub fn run() -> Result<(), ReplayError> {
    let (vehicle, mut drive) = Recorded::open()?;
    // In its place: the stack is smaller than the estimator.
    let estimator = Estimator::new_in(ESTIMATOR.uninit(), &vehicle, &Tuning::default())
        .map_err(Unusable::Vehicle)?;

    let mut road = Road::open()?;
    let mut cells = Cells {
        file: create(CELLS_FILE)?,
        count: 0,
        last_grade_percent: Uncertain::default(),
    };
    loop {
        let block = drive.next_block()?;
        if block.len() == 0 {
            break;
        }
        for frame in block {
            let (time, frame) = frame?;
            estimator.on_frame(time, &frame);
            while let Some(step) = estimator.step() {
                log_estimate(estimator, step);
                if let (Some(road), Step::Moved) = (&mut road, step) {
                    road.advance(estimator)?;
                }
                while let Some(cell) = estimator.next_cell() {
                    cells.write(&cell)?;
                    if let Some(road) = &mut road {
                        road.on_map.finish(&cell);
                    }
                }
            }
        }
    }
    while estimator.drain_step() {
        while let Some(cell) = estimator.next_cell() {
            cells.write(&cell)?;
        }
    }
    defmt::info!("{}", estimator.counters());
    if let Some(road) = &road {
        defmt::info!("{}", road.on_map.map().counters());
    }
    let grade = cells.last_grade_percent;
    defmt::info!(
        "{} frames, {} cells, last grade {} ± {} %",
        drive.frames(),
        cells.count,
        grade.value,
        grade.sigma
    );
    Ok(())
}

/// Logs the estimate each kilometre.
fn log_estimate(estimator: &Estimator<f32>, step: Step) {
    if let Some(live) = estimator.live().filter(|_| step == Step::Moved)
        && live.end.cell % CELLS_PER_KM == 0
    {
        defmt::info!("{}", live);
    }
}

/// The writer of [`CELLS_FILE`].
struct Cells {
    file: File,
    count: u32,
    last_grade_percent: Uncertain,
}

impl Cells {
    fn write(&mut self, cell: &Cell) -> Result<(), ReplayError> {
        self.count += 1;
        self.last_grade_percent = cell.lagged_grade_percent;
        let record = cell::encode(cell);
        let written = self.file.write_all(&record);
        written.map_err(|error| ReplayError::Write(CELLS_FILE, error))
    }
}

/// The map, and the writer of [`ON_MAP_FILE`].
struct Road {
    on_map: &'static mut OnMap<'static>,
    file: File,
}

impl Road {
    /// Opens the map in flash; `None` if there is none.
    fn open() -> Result<Option<Self>, ReplayError> {
        let Ok(map) = map_region::open() else {
            return Ok(None);
        };
        defmt::info!("a map of {} bytes", map.len());
        let on_map = ON_MAP.init_with(|| OnMap::new(map));
        let file = create(ON_MAP_FILE)?;
        Ok(Some(Self { on_map, file }))
    }

    fn advance(&mut self, estimator: &Estimator<f32>) -> Result<(), ReplayError> {
        let Some(live) = estimator.live() else {
            return Ok(());
        };
        self.on_map.advance(&live);
        let record = on_map::encode::<RecordedFrame>(self.on_map, &live);
        let written = self.file.write_all(&record);
        written.map_err(|error| ReplayError::Write(ON_MAP_FILE, error))
    }
}

fn create(name: &'static CStr) -> Result<File, ReplayError> {
    File::create(name).map_err(|error| ReplayError::Write(name, error))
}

impl fmt::Display for ReplayError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Drive(unusable) => write!(f, "{unusable}"),
            Self::Write(name, error) => write!(f, "{name:?}: {error}"),
        }
    }
}
