//! The road ahead as CAN frames: PCC1, and a profile of grades.

use super::coding::{Coding, GRADE_PERCENT, frame};
use crate::cell::{CELL_LENGTH_M, Uncertain};
use crate::roadmap::{HorizonPart, NextGrade, NumberedPart};
use embedded_can::Frame;

/// Parameter group of PCC1, predictive cruise control 1 (J1939-71). Ten frames a second are its rate.
pub const PCC1_PGN: u32 = 0xF0D3;
/// Parameter group of the profile ahead.
pub const AHEAD_PGN: u32 = 0xFF4A;

/// SPN 7432 and 7433.
const ROADWAY_GRADE_PERCENT: Coding = Coding::new(0.125, -16.0);
/// SPN 9199.
const STEPS_OF_25_M: Coding = Coding::new(25.0, 0.0);
const METRES: Coding = Coding::new(1.0, 0.0);
const PROBABILITY: Coding = Coding::new(0.004, 0.0);
const AHEAD_SIGMA_PERCENT: Coding = Coding::new(0.01, 0.0);

/// What a frame of the profile contains, in its lowest two bits.
const BRANCH: u8 = 0;
const GRADES: u8 = 1;
const UNKNOWN: u8 = 2;

/// Returns PCC1 with the source address `source`: the grade under the wheels, and the next grade of the
/// road with its distance. What is not known is "not available", as are all other fields of PCC1.
/// `None` if the frame type does not take eight bytes.
#[must_use]
pub fn pcc1<F: Frame>(
    grade_percent: Option<f32>,
    next: Option<NextGrade>,
    source: u8,
) -> Option<F> {
    let mut data = [u8::MAX; 8];
    if let Some(grade) = grade_percent {
        data[3] = ROADWAY_GRADE_PERCENT.byte(grade);
    }
    if let Some(next) = next {
        data[4] = ROADWAY_GRADE_PERCENT.byte(next.grade_percent);
        data[6] = STEPS_OF_25_M.byte(next.ahead_m);
    }
    frame(PCC1_PGN, source, &data)
}

/// Returns a frame of the profile ahead with the source address `source`. `None` if the frame type does
/// not take eight bytes.
#[must_use]
pub fn ahead<F: Frame>(part: &NumberedPart, source: u8) -> Option<F> {
    let data = match part.part {
        HorizonPart::Unknown => {
            let mut data = [u8::MAX; 8];
            data[0] = head(part, UNKNOWN, 3);
            data
        }
        HorizonPart::Branch {
            branch,
            from_m,
            to_m,
            probability,
        } => {
            let [c0, c1, c2, _] = part.cell.to_le_bytes();
            let [f0, f1] = METRES.word(from_m);
            [
                head(part, BRANCH, branch),
                STEPS_OF_25_M.byte(to_m),
                f0,
                f1,
                PROBABILITY.byte(probability),
                c0,
                c1,
                c2,
            ]
        }
        HorizonPart::Grades {
            branch,
            ahead_m,
            grades_percent: [first, second],
        } => {
            let [a0, a1, a2] = grade(first);
            let [b0, b1, b2] = grade(second);
            let ahead = STEPS_OF_25_M.byte(ahead_m);
            [head(part, GRADES, branch), ahead, a0, a1, a2, b0, b1, b2]
        }
    };
    frame(AHEAD_PGN, source, &data)
}

/// Returns the first byte: content, branch, number of the horizon.
fn head(part: &NumberedPart, content: u8, branch: u8) -> u8 {
    content | (branch & 3) << 2 | (part.sequence & 15) << 4
}

/// Returns grade and sigma.
fn grade(grade_percent: Option<Uncertain>) -> [u8; 3] {
    let Some(Uncertain { value, sigma }) = grade_percent else {
        return [u8::MAX; 3];
    };
    let [low, high] = GRADE_PERCENT.word(value);
    [low, high, AHEAD_SIGMA_PERCENT.byte(sigma)]
}

const _: () = assert!(CELL_LENGTH_M == 2.5, "the layout counts cells of 2.5 m");
