//! The two forms in which a cell waits for what follows it.

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
    pub consistent: bool,
}

/// A cell that was smoothed by its block and waits for later blocks.
///
/// Some two hundred of them wait, so it has no padding, and no word for one bit.
#[derive(Clone, Copy, Debug)]
pub(super) struct PendingCell<S> {
    cell: u32,
    /// Low and high half of the microseconds: together they would ask for a multiple of 8 bytes.
    time: [u32; 2],
    /// Latitude and longitude, 1e-7 degrees; [`NO_LATITUDE`] without a position.
    position_e7: (i32, i32),
    speed_mps: f32,
    live_grade_percent: Uncertain,
    altitude_m: Maybe,
    altitude_sigma_m: f32,
    /// Its covariance is with the states at the end of the block.
    slope: QuantityEstimate<S>,
    switches: u8,
}

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
    const fn bit(self, is_on: bool) -> u8 {
        (is_on as u8) << self as u8
    }

    const fn is_on(self, switches: u8) -> bool {
        switches & self.bit(true) != 0
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

impl<S: Scalar> PendingCell<S> {
    /// Makes a pending cell of one that its block has smoothed.
    #[inline(always)] // Into its place in the queue.
    pub fn new(filtered: &FilteredCell<S>, within: &WithinBlock<S>) -> Self {
        let end = &filtered.end;
        let micros = end.time.micros();
        let Condition {
            shifting,
            braking,
            no_traction,
            crawling,
        } = end.condition;
        Self {
            cell: end.cell,
            time: [micros as u32, (micros >> 32) as u32],
            position_e7: end.position_e7.unwrap_or((NO_LATITUDE, 0)),
            speed_mps: end.speed_mps,
            live_grade_percent: filtered.slope.grade(),
            altitude_m: within.altitude_m.map(|altitude| altitude.value).into(),
            altitude_sigma_m: within.altitude_m.map_or(0.0, |altitude| altitude.sigma),
            slope: within.slope,
            switches: Switch::Shifting.bit(shifting)
                | Switch::Braking.bit(braking)
                | Switch::NoTraction.bit(no_traction)
                | Switch::Crawling.bit(crawling)
                | Switch::LiveConsistent.bit(filtered.consistent)
                | Switch::LaggedConsistent.bit(within.consistent),
        }
    }

    /// Returns the slope, whose covariance is with the states at the end of the block.
    pub const fn slope(&self) -> &QuantityEstimate<S> {
        &self.slope
    }

    /// Returns the finished cell. From cell `disagreeing_since` on, later blocks disagree.
    #[inline(always)] // As new().
    pub fn finish(&self, lagged_grade_percent: Uncertain, disagreeing_since: u32) -> Cell {
        let is_on = |switch: Switch| switch.is_on(self.switches);
        let [low, high] = self.time.map(u64::from);
        let sigma = self.altitude_sigma_m;
        Cell {
            end: CellEnd {
                cell: self.cell,
                time: Instant::from_micros(high << 32 | low),
                position_e7: (self.position_e7.0 != NO_LATITUDE).then_some(self.position_e7),
                speed_mps: self.speed_mps,
                condition: Condition {
                    shifting: is_on(Switch::Shifting),
                    braking: is_on(Switch::Braking),
                    no_traction: is_on(Switch::NoTraction),
                    crawling: is_on(Switch::Crawling),
                },
            },
            live_grade_percent: self.live_grade_percent,
            lagged_grade_percent,
            altitude_m: self
                .altitude_m
                .get()
                .map(|value| Uncertain { value, sigma }),
            live_consistent: is_on(Switch::LiveConsistent),
            lagged_consistent: is_on(Switch::LaggedConsistent) && self.cell < disagreeing_since,
        }
    }
}
