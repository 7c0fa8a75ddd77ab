//! A flash memory that loses its power, and one whose sectors wear out.

use embedded_storage::nor_flash::{
    ErrorType, NorFlash, NorFlashErrorKind, ReadNorFlash, check_erase, check_read, check_write,
};
use estimator_core::roadmap::memory::{MappedFlash, RoadMemory, SECTOR_BYTES, Sector};
use std::ops::Range;

/// A road memory of a test.
pub type Memory = RoadMemory<TestFlash, Vec<Sector>>;

/// A flash memory in RAM.
#[derive(Clone, Debug)]
pub struct TestFlash {
    pub bytes: Vec<u8>,
    /// Operations so far.
    pub operations: usize,
    /// Operation at which the power is lost, and the part of it that is still done, 1/255.
    pub cut: Option<(usize, u8)>,
    /// A sector that holds nothing any more.
    pub worn: Option<usize>,
}

impl TestFlash {
    pub fn blank(sectors: usize) -> Self {
        Self::of(vec![0xff; sectors * SECTOR_BYTES])
    }

    pub const fn of(bytes: Vec<u8>) -> Self {
        Self {
            bytes,
            operations: 0,
            cut: None,
            worn: None,
        }
    }

    pub fn open(self) -> Memory {
        let sectors = vec![Sector::default(); self.bytes.len() / SECTOR_BYTES];
        Memory::open(self, sectors).expect("a memory")
    }

    /// Returns the part of an operation on these bytes that is done.
    fn powered(&mut self, range: Range<usize>) -> (Range<usize>, bool) {
        let operation = self.operations;
        self.operations += 1;
        match self.cut {
            Some((at, part)) if operation == at => {
                let done = range.len() * usize::from(part) / 255;
                (range.start..range.start + done, false)
            }
            Some((at, _)) if operation > at => (range.start..range.start, false),
            _ => (range, true),
        }
    }
}

impl ErrorType for TestFlash {
    type Error = NorFlashErrorKind;
}

impl ReadNorFlash for TestFlash {
    const READ_SIZE: usize = 1;

    fn read(&mut self, offset: u32, bytes: &mut [u8]) -> Result<(), Self::Error> {
        check_read(self, offset, bytes.len())?;
        let start = offset as usize;
        bytes.copy_from_slice(&self.bytes[start..start + bytes.len()]);
        Ok(())
    }

    fn capacity(&self) -> usize {
        self.bytes.len()
    }
}

impl NorFlash for TestFlash {
    const WRITE_SIZE: usize = 256;
    const ERASE_SIZE: usize = SECTOR_BYTES;

    fn erase(&mut self, from: u32, to: u32) -> Result<(), Self::Error> {
        check_erase(self, from, to)?;
        let (range, is_done) = self.powered(from as usize..to as usize);
        self.bytes[range].fill(0xff);
        is_done.then_some(()).ok_or(NorFlashErrorKind::Other)
    }

    fn write(&mut self, offset: u32, bytes: &[u8]) -> Result<(), Self::Error> {
        check_write(self, offset, bytes.len())?;
        let start = offset as usize;
        let (range, is_done) = self.powered(start..start + bytes.len());
        if self.worn != Some(start / SECTOR_BYTES) {
            for (cell, byte) in self.bytes[range].iter_mut().zip(bytes) {
                // An erased byte is written once.
                assert_eq!(*cell, 0xff, "written twice");
                *cell = *byte;
            }
        }
        is_done.then_some(()).ok_or(NorFlashErrorKind::Other)
    }
}

impl MappedFlash for TestFlash {
    fn bytes(&self) -> &[u8] {
        &self.bytes
    }
}

/// A flash memory that erases and writes in other pieces.
#[derive(Clone, Debug)]
pub struct InPieces<const ERASE: usize, const WRITE: usize>(pub TestFlash);

impl<const ERASE: usize, const WRITE: usize> ErrorType for InPieces<ERASE, WRITE> {
    type Error = NorFlashErrorKind;
}

impl<const ERASE: usize, const WRITE: usize> ReadNorFlash for InPieces<ERASE, WRITE> {
    const READ_SIZE: usize = 1;

    fn read(&mut self, offset: u32, bytes: &mut [u8]) -> Result<(), Self::Error> {
        self.0.read(offset, bytes)
    }

    fn capacity(&self) -> usize {
        self.0.capacity()
    }
}

impl<const ERASE: usize, const WRITE: usize> NorFlash for InPieces<ERASE, WRITE> {
    const WRITE_SIZE: usize = WRITE;
    const ERASE_SIZE: usize = ERASE;

    fn erase(&mut self, from: u32, to: u32) -> Result<(), Self::Error> {
        self.0.erase(from, to)
    }

    fn write(&mut self, offset: u32, bytes: &[u8]) -> Result<(), Self::Error> {
        self.0.write(offset, bytes)
    }
}

impl<const ERASE: usize, const WRITE: usize> MappedFlash for InPieces<ERASE, WRITE> {
    fn bytes(&self) -> &[u8] {
        self.0.bytes()
    }
}
