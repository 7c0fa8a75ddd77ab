//! The estimate as CAN frames, for other nodes of the bus.
//!
//! Two messages of the range that J1939-21 leaves to manufacturers. `dbc/grade.dbc` has their layout.
//! They are coded as in J1939-71: steps and offsets, all ones for "not available", and the ends of
//! the range for values beyond it.

use crate::cell::{Cell, Condition, Live, Uncertain};
use embedded_can::{ExtendedId, Frame, Id};

/// Parameter group of the live estimate. Ten frames a second are a good rate.
pub const LIVE_PGN: u32 = 0xFF46;
/// Parameter group of a finished cell.
pub const CELL_PGN: u32 = 0xFF47;
/// The default of J1939-21 for information.
const PRIORITY: u32 = 6;

/// Largest raw values that are no code (J1939-71, table 1).
const LARGEST_BYTE: f32 = 250.0;
const LARGEST_WORD: f32 = 64_255.0;

/// Step and offset of a coding.
#[derive(Clone, Copy)]
struct Coding {
    step: f32,
    offset: f32,
}

const GRADE_PERCENT: Coding = Coding::new(0.002, -64.0);
const GRADE_SIGMA_PERCENT: Coding = Coding::new(0.02, 0.0);
const SCALE: Coding = Coding::new(0.0001, 0.0);
const ALTITUDE_M: Coding = Coding::new(0.125, -2_500.0);

/// Returns the frame of the live estimate with the source address `source`. All fields are "not
/// available" without an estimate. `None` if the frame type does not take eight bytes.
#[must_use]
pub fn live<F: Frame>(live: Option<&Live>, source: u8) -> Option<F> {
    let mut data = [u8::MAX; 8];
    if let Some(live) = live {
        let estimate = &live.estimate;
        let grade = GRADE_PERCENT.word(estimate.grade_percent.value);
        let bias = GRADE_PERCENT.word(estimate.bias_percent.value);
        let scale = SCALE.word(estimate.scale.value);
        let sigma = GRADE_SIGMA_PERCENT.byte(estimate.grade_percent.sigma);
        let status = status(live.end.condition);
        data = [
            grade[0], grade[1], sigma, status, bias[0], bias[1], scale[0], scale[1],
        ];
    }
    frame(LIVE_PGN, source, &data)
}

/// Returns the frame of a finished cell with the source address `source`. Its number counts cells of
/// 2.5 m and wraps after 41,943 km. `None` if the frame type does not take eight bytes.
#[must_use]
pub fn cell<F: Frame>(cell: &Cell, source: u8) -> Option<F> {
    let [n0, n1, n2, _] = cell.end.cell.to_le_bytes();
    let Uncertain { value, sigma } = cell.lagged_grade_percent;
    let grade = GRADE_PERCENT.word(value);
    let altitude = cell
        .altitude_m
        .map_or([u8::MAX; 2], |altitude| ALTITUDE_M.word(altitude.value));
    let sigma = GRADE_SIGMA_PERCENT.byte(sigma);
    let data = [
        n0,
        n1,
        n2,
        grade[0],
        grade[1],
        sigma,
        altitude[0],
        altitude[1],
    ];
    frame(CELL_PGN, source, &data)
}

fn frame<F: Frame>(pgn: u32, source: u8, data: &[u8; 8]) -> Option<F> {
    let id = ExtendedId::new(PRIORITY << 26 | pgn << 8 | u32::from(source))?;
    F::new(Id::Extended(id), data)
}

/// Returns two bits for each condition, as J1939-71 codes a switch: 0 off, 1 on.
fn status(condition: Condition) -> u8 {
    let Condition {
        shifting,
        braking,
        no_traction,
        crawling,
    } = condition;
    [shifting, braking, no_traction, crawling]
        .into_iter()
        .rev()
        .fold(0, |bits, on| bits << 2 | u8::from(on))
}

impl Coding {
    const fn new(step: f32, offset: f32) -> Self {
        Self { step, offset }
    }

    /// Returns the rounded raw value, limited to the range; `None` for NaN.
    fn steps(self, value: f32, largest: f32) -> Option<f32> {
        let steps = (value - self.offset) / self.step + 0.5;
        (!steps.is_nan()).then(|| steps.max(0.0).min(largest))
    }

    fn byte(self, value: f32) -> u8 {
        self.steps(value, LARGEST_BYTE)
            .map_or(u8::MAX, |steps| steps as u8)
    }

    fn word(self, value: f32) -> [u8; 2] {
        let steps = self.steps(value, LARGEST_WORD);
        steps.map_or(u16::MAX, |steps| steps as u16).to_le_bytes()
    }
}
