//! The coding of J1939-71: steps and offsets, all ones for "not available", and the ends of the range
//! for values beyond it.

use crate::scalar::Scalar;
use embedded_can::{ExtendedId, Frame, Id};

/// The default of J1939-21 for information.
const PRIORITY: u32 = 6;
/// Largest raw values that are no code (J1939-71, table 1).
const LARGEST_BYTE: f32 = 250.0;
const LARGEST_WORD: f32 = 64_255.0;

/// Step and offset of a coding.
#[derive(Clone, Copy)]
pub(super) struct Coding {
    step: f32,
    offset: f32,
}

/// As in `GradeLive` and the other frames of the manufacturer's range.
pub(super) const GRADE_PERCENT: Coding = Coding::new(0.002, -64.0);

impl Coding {
    pub(super) const fn new(step: f32, offset: f32) -> Self {
        Self { step, offset }
    }

    /// Returns the rounded raw value, limited to the range; `None` for NaN.
    fn steps(self, value: f32, largest: f32) -> Option<f32> {
        let steps = (value - self.offset) / self.step + 0.5;
        (!steps.is_nan()).then(|| Scalar::min(largest, Scalar::max(0.0, steps)))
    }

    #[inline(never)] // Frames have many bytes.
    pub(super) fn byte(self, value: f32) -> u8 {
        self.steps(value, LARGEST_BYTE)
            .map_or(u8::MAX, |steps| steps as u8)
    }

    #[inline(never)] // As byte().
    pub(super) fn word(self, value: f32) -> [u8; 2] {
        let steps = self.steps(value, LARGEST_WORD);
        steps.map_or(u16::MAX, |steps| steps as u16).to_le_bytes()
    }
}

/// Returns a frame to all with the source address `source`; `None` if the frame type does not take
/// eight bytes.
pub(super) fn frame<F: Frame>(pgn: u32, source: u8, data: &[u8; 8]) -> Option<F> {
    let id = ExtendedId::new(PRIORITY << 26 | pgn << 8 | u32::from(source))?;
    F::new(Id::Extended(id), data)
}
