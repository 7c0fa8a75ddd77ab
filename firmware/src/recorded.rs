//! A recorded drive, read by semihosting in blocks, since each read stops the processor.

use crate::exchange::DRIVE_FILE;
use crate::exchange::frame::{self, FRAME_BYTES, RecordedFrame};
use core::fmt;
use estimator_core::packed_vehicle::{self, PackedVehicleError, VEHICLE_BYTES};
use estimator_core::{Instant, Model, ParameterError};
use semihosting::fs::File;
use semihosting::io::{self, Read};

/// Number of frames in a block.
const BLOCK_FRAMES: usize = 128;

/// An open [`DRIVE_FILE`].
#[derive(Debug)]
pub struct Recorded {
    file: File,
    block: [u8; BLOCK_FRAMES * FRAME_BYTES],
    frames: u32,
}

/// Why a drive cannot be used.
#[derive(Debug)]
pub enum Unusable {
    /// The file cannot be read.
    Read(io::Error),
    /// The header is refused.
    Header(PackedVehicleError),
    /// The record of this frame, counted from 1, is malformed.
    Frame(u32),
    /// A parameter of the vehicle is impossible.
    Vehicle(ParameterError),
}

impl Recorded {
    /// Opens the drive. Returns it with the model of its vehicle.
    ///
    /// # Errors
    /// The file cannot be read, or its header is refused.
    pub fn open() -> Result<(Model, Self), Unusable> {
        let mut file = File::open(DRIVE_FILE).map_err(Unusable::Read)?;
        let mut header = [0; VEHICLE_BYTES];
        let filled = fill(&mut file, &mut header)?;
        let model = packed_vehicle::decode(&header[..filled]).map_err(Unusable::Header)?;
        let recorded = Self {
            file,
            block: [0; BLOCK_FRAMES * FRAME_BYTES],
            frames: 0,
        };
        Ok((model, recorded))
    }

    /// Returns the next frames with their times of reception; none at the end.
    ///
    /// # Errors
    /// The file cannot be read. Each malformed frame is an error of its own.
    pub fn next_block(
        &mut self,
    ) -> Result<
        impl ExactSizeIterator<Item = Result<(Instant, RecordedFrame), Unusable>> + '_,
        Unusable,
    > {
        let filled = fill(&mut self.file, &mut self.block)?;
        let frames = &mut self.frames;
        Ok(self.block[..filled].chunks(FRAME_BYTES).map(|record| {
            *frames += 1;
            frame::decode(record).ok_or(Unusable::Frame(*frames))
        }))
    }

    /// Returns the number of frames so far.
    #[must_use]
    pub const fn frames(&self) -> u32 {
        self.frames
    }
}

/// Reads until the buffer is full or the file ends. Returns the number of bytes.
fn fill(file: &mut File, buffer: &mut [u8]) -> Result<usize, Unusable> {
    let mut filled = 0;
    while filled < buffer.len() {
        match file.read(&mut buffer[filled..]).map_err(Unusable::Read)? {
            0 => break,
            count => filled += count,
        }
    }
    Ok(filled)
}

impl fmt::Display for Unusable {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Read(error) => write!(f, "{DRIVE_FILE:?}: {error}"),
            Self::Header(error) => write!(f, "{DRIVE_FILE:?}: {error}"),
            Self::Frame(number) => write!(f, "{DRIVE_FILE:?}: frame {number} is malformed"),
            Self::Vehicle(error) => write!(f, "{DRIVE_FILE:?}: {error}"),
        }
    }
}
