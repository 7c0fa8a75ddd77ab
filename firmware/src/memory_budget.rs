//! The cost of the road memory on the board. Its flash memory is RAM here, so that erasing and writing
//! take as many instructions as filling and copying do.
//!
//! The drive runs twice: the road is new, then known.

use crate::counted::{BudgetError, create};
use crate::meter::{CountTally, InstructionMeter, depth};
use crate::recorded::{Recorded, Unusable};
use core::fmt;
use core::mem::MaybeUninit;
use embedded_storage::nor_flash::{
    ErrorType, NorFlash, NorFlashErrorKind, ReadNorFlash, check_erase, check_read, check_write,
};
use estimator_core::roadmap::memory::{MappedFlash, RoadMemory, SECTOR_BYTES, Sector};
use estimator_core::{Estimator, Scalar, Step};

/// Bytes of the flash memory: the fewest that a road memory is meant for.
pub const FLASH_BYTES: usize = 65_536;
/// Its sectors.
pub const SECTORS: usize = FLASH_BYTES / SECTOR_BYTES;

type Memory<'a> = RoadMemory<RamFlash<'a>, [Sector; SECTORS]>;

/// The counts of the road memory.
#[derive(Clone, Copy, Debug, Default)]
pub struct MemoryBudget {
    stack_bytes: usize,
    /// The place on a known road and the grade there, after a step.
    step: CountTally,
    /// A finished cell, on a new road or a known one.
    finish: CountTally,
    /// A finished cell with which pages are written.
    write: CountTally,
}

/// A flash memory in RAM.
pub struct RamFlash<'a>(pub &'a mut [u8; FLASH_BYTES]);

impl MemoryBudget {
    /// Counts both drives.
    ///
    /// # Errors
    /// The drive is unusable, or a call is too long to count.
    pub fn run<S: Scalar>(
        meter: &mut InstructionMeter,
        place: &mut MaybeUninit<Estimator<S>>,
        bytes: &mut [u8; FLASH_BYTES],
    ) -> Result<Self, BudgetError> {
        bytes.fill(0xff);
        let mut budget = Self::default();
        budget.drive(meter, place, bytes)?;
        // On a new road there is no place to find.
        budget.step = CountTally::default();
        budget.drive(meter, place, bytes)?;
        Ok(budget)
    }

    fn drive<S: Scalar>(
        &mut self,
        meter: &mut InstructionMeter,
        place: &mut MaybeUninit<Estimator<S>>,
        bytes: &mut [u8; FLASH_BYTES],
    ) -> Result<(), BudgetError> {
        let (model, mut drive) = Recorded::open()?;
        let estimator = create(place, &model).map_err(Unusable::Vehicle)?;
        let sectors = [Sector::default(); SECTORS];
        let mut memory = Memory::open(RamFlash(bytes), sectors).map_err(BudgetError::Memory)?;
        loop {
            let block = drive.next_block()?;
            if block.len() == 0 {
                return memory.close().map_err(BudgetError::Memory);
            }
            let (done, bytes) = depth(|| {
                for frame in block {
                    let (time, frame) = frame?;
                    estimator.on_frame(time, &frame);
                    while self.step(meter, estimator, &mut memory)? {}
                }
                Ok::<(), BudgetError>(())
            });
            done?;
            self.stack_bytes = self.stack_bytes.max(bytes);
        }
    }

    fn step<S: Scalar>(
        &mut self,
        meter: &mut InstructionMeter,
        estimator: &mut Estimator<S>,
        memory: &mut Memory<'_>,
    ) -> Result<bool, BudgetError> {
        let Some(step) = estimator.step() else {
            return Ok(false);
        };
        if let (Step::Moved, Some(live)) = (step, estimator.live()) {
            let (_, count) = meter.count(|| memory.advance(&live))?;
            self.step.add(count);
        }
        while let Some(cell) = estimator.next_cell() {
            let writes = memory.counters().writes;
            let (finished, count) = meter.count(|| memory.finish(&cell))?;
            finished.map_err(BudgetError::Memory)?;
            if memory.counters().writes == writes {
                self.finish.add(count);
            } else {
                self.write.add(count);
            }
        }
        Ok(true)
    }
}

/// Prints one figure a line, name and number.
impl fmt::Display for MemoryBudget {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "memory_bytes {}", size_of::<Memory<'_>>())?;
        writeln!(f, "memory_stack_bytes {}", self.stack_bytes)?;
        writeln!(f, "memory_step_mean {}", self.step.mean())?;
        writeln!(f, "memory_step_worst {}", self.step.worst())?;
        writeln!(f, "memory_finish_mean {}", self.finish.mean())?;
        writeln!(f, "memory_finish_worst {}", self.finish.worst())?;
        writeln!(f, "memory_write_worst {}", self.write.worst())
    }
}

impl ErrorType for RamFlash<'_> {
    type Error = NorFlashErrorKind;
}

impl ReadNorFlash for RamFlash<'_> {
    const READ_SIZE: usize = 1;

    fn read(&mut self, offset: u32, bytes: &mut [u8]) -> Result<(), Self::Error> {
        check_read(self, offset, bytes.len())?;
        bytes.copy_from_slice(&self.0[offset as usize..][..bytes.len()]);
        Ok(())
    }

    fn capacity(&self) -> usize {
        FLASH_BYTES
    }
}

impl NorFlash for RamFlash<'_> {
    const WRITE_SIZE: usize = 256;
    const ERASE_SIZE: usize = SECTOR_BYTES;

    fn erase(&mut self, from: u32, to: u32) -> Result<(), Self::Error> {
        check_erase(self, from, to)?;
        self.0[from as usize..to as usize].fill(0xff);
        Ok(())
    }

    fn write(&mut self, offset: u32, bytes: &[u8]) -> Result<(), Self::Error> {
        check_write(self, offset, bytes.len())?;
        self.0[offset as usize..][..bytes.len()].copy_from_slice(bytes);
        Ok(())
    }
}

impl MappedFlash for RamFlash<'_> {
    fn bytes(&self) -> &[u8] {
        self.0
    }
}
