//! The estimate as CAN frames, for other nodes of the bus.
//!
//! Messages of the range that J1939-21 leaves to manufacturers, and PCC1, the form that J1939-71 has for
//! a grade of the road. `dbc/grade.dbc` has their layout. They are coded as in J1939-71: steps and
//! offsets, all ones for "not available", and the ends of the range for values beyond it.

mod ahead;
mod coding;

pub use ahead::{AHEAD_PGN, PCC1_PGN, ahead, pcc1};

use crate::cell::{Cell, Condition, Disagreement, Live, Uncertain};
use coding::{Coding, GRADE_PERCENT, frame};
use embedded_can::Frame;

/// Parameter group of the live estimate. Ten frames a second are a good rate.
pub const LIVE_PGN: u32 = 0xFF46;
/// Parameter group of a finished cell.
pub const CELL_PGN: u32 = 0xFF47;
/// Parameter group of the status. One frame a second and one at each change of its switches are a
/// good rate. The group between is that of the host's log time.
pub const STATUS_PGN: u32 = 0xFF49;
/// State of a switch that is not known.
const NOT_AVAILABLE: u8 = 3;

const GRADE_SIGMA_PERCENT: Coding = Coding::new(0.02, 0.0);
const SCALE: Coding = Coding::new(0.0001, 0.0);
const ALTITUDE_M: Coding = Coding::new(0.125, -2_500.0);
/// As in SPN 1760, gross combination vehicle weight.
const MASS_KG: Coding = Coding::new(10.0, 0.0);

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
        let conditions = conditions(live.end.condition);
        data = [
            grade[0], grade[1], sigma, conditions, bias[0], bias[1], scale[0], scale[1],
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

/// Returns the frame of the status with the source address `source`: whether the live estimate is
/// consistent and what disagrees, gross mass, whether the newest finished cell is consistent, and
/// the number of suspect cells, which wraps at 65,536. All fields are "not available" without an
/// estimate. `None` if the frame type does not take eight bytes.
#[must_use]
pub fn status<F: Frame>(
    live: Option<&Live>,
    newest: Option<&Cell>,
    cells_suspect: u32,
    source: u8,
) -> Option<F> {
    let mut data = [u8::MAX; 8];
    if let Some(live) = live {
        let [first, second] = status_switches(live.disagreement, newest);
        let Uncertain { value, sigma } = live.estimate.mass_kg;
        let (mass, sigma) = (MASS_KG.word(value), MASS_KG.word(sigma));
        let [n0, n1, ..] = cells_suspect.to_le_bytes();
        data = [first, second, mass[0], mass[1], sigma[0], sigma[1], n0, n1];
    }
    frame(STATUS_PGN, source, &data)
}

/// Returns the first two bytes of the status, two bits for each switch.
fn status_switches(disagreement: Disagreement, newest: Option<&Cell>) -> [u8; 2] {
    let Disagreement {
        climb,
        brake,
        torque,
        speed,
        gear,
    } = disagreement;
    let lagged = newest.map_or(NOT_AVAILABLE, |cell| u8::from(cell.lagged_consistent));
    [
        switches([disagreement.is_none(), climb, brake, torque].map(u8::from)),
        switches([u8::from(speed), u8::from(gear), lagged, NOT_AVAILABLE]),
    ]
}

/// Returns two bits for each condition.
fn conditions(condition: Condition) -> u8 {
    let Condition {
        shifting,
        braking,
        no_traction,
        crawling,
    } = condition;
    switches([shifting, braking, no_traction, crawling].map(u8::from))
}

/// Returns a byte of switches, the first one in the lowest bits. J1939-71 codes a switch in two bits:
/// 0 off, 1 on, 3 not available.
fn switches(states: [u8; 4]) -> u8 {
    states
        .into_iter()
        .rev()
        .fold(0, |bits, state| bits << 2 | state)
}
