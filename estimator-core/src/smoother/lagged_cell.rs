//! The forms in which a cell waits: for the end of its block, for later blocks, and to be fetched.

use crate::cell::{Cell, CellEnd, Condition, Uncertain};
use crate::filter::{QuantityEstimate, SmootherInput};
use crate::maybe::Maybe;
use crate::scalar::Scalar;
use crate::time::Instant;

/// A cell of a block that is not closed: what the filter left.
#[derive(Clone, Copy, Debug)]
pub(super) struct FilteredCell<S> {
    pub end: CellEnd,
    pub smoother_input: SmootherInput<S>,
    pub slope: QuantityEstimate<S>,
    pub altitude: QuantityEstimate<S>,
    pub origin_m: Option<f32>,
    pub doubt_variance: f32,
    pub consistent: bool,
}

/// What the filter and its block say of a cell, in few bytes.
///
/// Some two hundred of them wait, so it has no padding, and no word for one bit.
#[derive(Clone, Copy, Debug)]
struct PackedCell {
    cell: u32,
    /// Microseconds and, in the lowest byte, the switches. Low and high half: together they would
    /// ask for a multiple of 8 bytes.
    time_and_switches: [u32; 2],
    /// Latitude and longitude, 1e-7 degrees; [`NO_LATITUDE`] without a position.
    position_e7: (i32, i32),
    speed_mps: f32,
    live_grade_percent: Uncertain,
    altitude_m: Maybe,
    altitude_sigma_m: f32,
}

/// A cell that was smoothed by its block and waits for later blocks.
#[derive(Clone, Copy, Debug)]
pub(super) struct PendingCell<S> {
    packed: PackedCell,
    /// Its covariance is with the states at the end of the block.
    slope: QuantityEstimate<S>,
}

/// A finished cell that waits to be fetched.
#[derive(Clone, Copy, Debug)]
pub(super) struct FinishedCell {
    packed: PackedCell,
    lagged_grade_percent: Uncertain,
}

/// Bits of the switches beside a time.
const SWITCH_BITS: u32 = 8;
/// The latest time that fits beside them, µs: some two thousand years.
const LATEST_MICROS: u64 = u64::MAX >> SWITCH_BITS;

/// A latitude that is none.
const NO_LATITUDE: i32 = i32::MIN;

/// A switch of a pending cell.
#[derive(Clone, Copy)]
enum Switch {
    Shifting,
    Braking,
    NoTraction,
    Crawling,
    LiveConsistent,
    LaggedConsistent,
}

impl Switch {
    const fn bit(self, is_on: bool) -> u32 {
        (is_on as u32) << self as u32
    }
}

/// What a block says of a cell in it.
#[derive(Clone, Copy, Debug)]
pub(super) struct WithinBlock<S> {
    /// The slope, whose covariance is with the states at the end of the block.
    pub slope: QuantityEstimate<S>,
    /// The altitude, m.
    pub altitude_m: Option<Uncertain>,
    /// Whether nothing disagrees in the cell, as far as it is known at the end of the block.
    pub consistent: bool,
}

impl PackedCell {
    const fn is_on(&self, switch: Switch) -> bool {
        let [low, _] = self.time_and_switches;
        low & switch.bit(true) != 0
    }

    const fn switch_off(&mut self, switch: Switch) {
        let [low, _] = &mut self.time_and_switches;
        *low &= !switch.bit(true);
    }
}

impl<S: Scalar> PendingCell<S> {
    /// Makes a pending cell of one that its block has smoothed.
    #[inline(always)] // Into its place in the queue.
    pub fn new(filtered: &FilteredCell<S>, within: &WithinBlock<S>) -> Self {
        let end = &filtered.end;
        let time = end.time.micros().min(LATEST_MICROS) << SWITCH_BITS;
        let Condition {
            shifting,
            braking,
            no_traction,
            crawling,
        } = end.condition;
        let switches = Switch::Shifting.bit(shifting)
            | Switch::Braking.bit(braking)
            | Switch::NoTraction.bit(no_traction)
            | Switch::Crawling.bit(crawling)
            | Switch::LiveConsistent.bit(filtered.consistent)
            | Switch::LaggedConsistent.bit(within.consistent);
        Self {
            packed: PackedCell {
                cell: end.cell,
                time_and_switches: [time as u32 | switches, (time >> 32) as u32],
                position_e7: end.position_e7.unwrap_or((NO_LATITUDE, 0)),
                speed_mps: end.speed_mps,
                live_grade_percent: filtered.slope.grade().widened(filtered.doubt_variance),
                altitude_m: within.altitude_m.map(|altitude| altitude.value).into(),
                altitude_sigma_m: within.altitude_m.map_or(0.0, |altitude| altitude.sigma),
            },
            slope: within.slope,
        }
    }

    /// Returns the slope, whose covariance is with the states at the end of the block.
    pub const fn slope(&self) -> &QuantityEstimate<S> {
        &self.slope
    }

    /// Returns the finished cell. From cell `disagreeing_since` on, later blocks disagree.
    #[inline(always)] // As new().
    pub fn finish(&self, lagged_grade_percent: Uncertain, disagreeing_since: u32) -> FinishedCell {
        let mut packed = self.packed;
        if packed.cell >= disagreeing_since {
            packed.switch_off(Switch::LaggedConsistent);
        }
        FinishedCell {
            packed,
            lagged_grade_percent,
        }
    }
}

impl FinishedCell {
    /// Returns the cell as it is fetched.
    pub fn unpack(&self) -> Cell {
        let packed = &self.packed;
        let [low, high] = packed.time_and_switches.map(u64::from);
        let sigma = packed.altitude_sigma_m;
        Cell {
            end: CellEnd {
                cell: packed.cell,
                time: Instant::from_micros((high << 32 | low) >> SWITCH_BITS),
                position_e7: (packed.position_e7.0 != NO_LATITUDE).then_some(packed.position_e7),
                speed_mps: packed.speed_mps,
                condition: Condition {
                    shifting: packed.is_on(Switch::Shifting),
                    braking: packed.is_on(Switch::Braking),
                    no_traction: packed.is_on(Switch::NoTraction),
                    crawling: packed.is_on(Switch::Crawling),
                },
            },
            live_grade_percent: packed.live_grade_percent,
            lagged_grade_percent: self.lagged_grade_percent,
            altitude_m: packed
                .altitude_m
                .get()
                .map(|value| Uncertain { value, sigma }),
            live_consistent: packed.is_on(Switch::LiveConsistent),
            lagged_consistent: packed.is_on(Switch::LaggedConsistent),
        }
    }
}
