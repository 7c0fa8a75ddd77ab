//! The flash memory of a vehicle as a file: the road memory on a host.

use super::kind::{self, Kind};
use super::limits::read_bytes;
use super::output::{self, Staged};
use crate::error::{Error, Result};
use embedded_storage::nor_flash::{
    ErrorType, NorFlash, NorFlashErrorKind, ReadNorFlash, check_erase, check_read, check_write,
};
use estimator_core::roadmap::memory::{
    FEWEST_SECTORS, MOST_SECTORS, MappedFlash, MemoryError, RoadMemory, SECTOR_BYTES, Sector,
};
use std::io::ErrorKind;
use std::path::Path;

/// Size of a new memory, bytes.
pub const DEFAULT_BYTES: usize = 1 << 20;

/// A road memory in a file.
pub type RoadMemoryFile = RoadMemory<FlashImage, Vec<Sector>>;

/// A flash memory in RAM.
#[derive(Clone, Debug)]
pub struct FlashImage(Vec<u8>);

impl FlashImage {
    /// Creates an empty one.
    #[must_use]
    pub fn blank(bytes: usize) -> Self {
        Self(vec![0xff; bytes])
    }
}

impl ErrorType for FlashImage {
    type Error = NorFlashErrorKind;
}

impl ReadNorFlash for FlashImage {
    const READ_SIZE: usize = 1;

    fn read(&mut self, offset: u32, bytes: &mut [u8]) -> std::result::Result<(), Self::Error> {
        check_read(self, offset, bytes.len())?;
        let start = offset as usize;
        bytes.copy_from_slice(&self.0[start..start + bytes.len()]);
        Ok(())
    }

    fn capacity(&self) -> usize {
        self.0.len()
    }
}

impl NorFlash for FlashImage {
    const WRITE_SIZE: usize = 1;
    const ERASE_SIZE: usize = SECTOR_BYTES;

    fn erase(&mut self, from: u32, to: u32) -> std::result::Result<(), Self::Error> {
        check_erase(self, from, to)?;
        self.0[from as usize..to as usize].fill(0xff);
        Ok(())
    }

    fn write(&mut self, offset: u32, bytes: &[u8]) -> std::result::Result<(), Self::Error> {
        check_write(self, offset, bytes.len())?;
        // A flash memory clears bits; only an erase sets them.
        for (cell, byte) in self.0[offset as usize..].iter_mut().zip(bytes) {
            *cell &= byte;
        }
        Ok(())
    }
}

impl MappedFlash for FlashImage {
    fn bytes(&self) -> &[u8] {
        &self.0
    }
}

/// Opens a road memory. If there is no such file, it is an empty one of this size; without a size it
/// has 1 MiB.
///
/// # Errors
/// Returns the error of the file system, or says that the file is none, or has another size.
pub fn open(path: &Path, bytes: Option<usize>) -> Result<RoadMemoryFile> {
    let image = match read_bytes(path, (MOST_SECTORS * SECTOR_BYTES) as u64) {
        Ok(image) => FlashImage(image),
        Err(Error::Io { source, .. }) if source.kind() == ErrorKind::NotFound => {
            FlashImage::blank(bytes.unwrap_or(DEFAULT_BYTES))
        }
        Err(error) => return Err(error),
    };
    kind::refuse_other(path, &[Kind::RoadMemory])?;
    let found = image.0.len();
    if bytes.is_some_and(|bytes| bytes != found) {
        let problem = format!(
            "has {found} bytes; expected as many as --memory-bytes says, or no --memory-bytes"
        );
        return Err(Error::content(path, problem));
    }
    let sectors = vec![Sector::default(); found / SECTOR_BYTES];
    let memory = RoadMemory::open(image, sectors).map_err(wrong(path))?;
    let opened = memory.opened();
    let is_other = opened.pages == 0 && opened.other_version == 0 && opened.damaged > 0;
    if !found.is_multiple_of(SECTOR_BYTES) || is_other {
        return Err(Error::content(path, NO_MEMORY));
    }
    Ok(memory)
}

const NO_MEMORY: &str = "is no road memory; expected one of `estimate --memory`, or no file";

fn wrong(path: &Path) -> impl Fn(MemoryError<NorFlashErrorKind>) -> Error {
    move |problem| match problem {
        MemoryError::Size => Error::content(path, NO_MEMORY),
        other => Error::content(path, other.to_string()),
    }
}

/// Reads a size of a road memory.
///
/// # Errors
/// Says what is expected.
pub fn parse_bytes(argument: &str) -> std::result::Result<usize, String> {
    let (least, most) = (FEWEST_SECTORS * SECTOR_BYTES, MOST_SECTORS * SECTOR_BYTES);
    argument
        .parse()
        .ok()
        .filter(|bytes: &usize| {
            (least..=most).contains(bytes) && bytes.is_multiple_of(SECTOR_BYTES)
        })
        .ok_or_else(|| format!("expected {least} to {most}, a multiple of {SECTOR_BYTES}"))
}

/// Returns whether a file is a road memory. Its first sector may be free, so all are looked at.
#[must_use]
pub fn is_memory(path: &Path) -> bool {
    // Opening a pipe may wait for ever.
    let length = path.metadata().ok().filter(std::fs::Metadata::is_file);
    length.is_some_and(|file| file.len().is_multiple_of(SECTOR_BYTES as u64))
        && open(path, None).is_ok()
}

/// Writes a road memory to a file that appears when it is committed.
///
/// # Errors
/// Returns the error of the file system.
pub fn stage(path: &Path, memory: &RoadMemoryFile) -> Result<Staged> {
    output::stage(path, |out| out.write_all(memory.flash().bytes()))
}
