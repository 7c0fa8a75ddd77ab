//! The window behind the vehicle: its cells are smoothed and weighed again and again.
//!
//! `live` takes a cell and moves the live state over it. Every 100 m the window is due for an update,
//! which is done in shares of work (`update`).

use super::doubt::DoubtFinder;
use super::hidden_brakes::HiddenBrakes;
use super::hypothesis::Hypothesis;
use super::levels::{LevelSums, Levels};
use super::past_steps::PastSteps;
use super::round::Pass;
use super::variances::SEGMENT_CELLS;
use super::work::Work;
use crate::cell::Disagreement;
use crate::filter::{CellInput, Moments, Record, State};
use crate::scalar::Scalar;
use crate::tuning::Numbers;
use heapless::Vec;

/// Cells between two updates of the window, two segments.
pub const UPDATE_CELLS: usize = 2 * SEGMENT_CELLS;
/// Cells of later measurements that a lagged estimate has at least, 500 m.
pub const LAG_CELLS: usize = 200;
/// Cells that stay in the window, 600 m.
pub const WINDOW_CELLS: usize = if WITH_WINDOW { 12 * SEGMENT_CELLS } else { 0 };
/// Whether there is a window.
const WITH_WINDOW: bool = cfg!(feature = "window");
/// Cells that it holds between two updates.
pub(super) const CAPACITY: usize = WINDOW_CELLS + UPDATE_CELLS;
/// Most cells that wait for their lagged estimate.
pub const WAITING_CELLS: usize = if WITH_WINDOW {
    LAG_CELLS + UPDATE_CELLS
} else {
    24
};
/// Most cells that are smoothed at once: those that wait, and the one before them.
pub(super) const SMOOTHED_CELLS: usize = if WITH_WINDOW { WAITING_CELLS + 1 } else { 1 };
/// Cells that one share of work goes over.
pub(super) const SHARE_CELLS: usize = 4;
/// Cells between two stored states.
pub(super) const BLOCK_CELLS: usize = SEGMENT_CELLS;
/// Stored states. The records of the last block are still there on the way back.
pub(super) const BLOCKS: usize = CAPACITY / BLOCK_CELLS - 1;
pub(super) const SEGMENTS: usize = CAPACITY / SEGMENT_CELLS;

/// The window of a drive.
#[derive(Clone, Debug)]
pub struct Window<S> {
    pub(super) cells: Vec<CellInput, CAPACITY>,
    /// What is inferred of them.
    pub(super) adopted: Hypothesis<S, CAPACITY, SEGMENTS>,
    /// The same if overrun hides brakes, while that is tried.
    pub(super) trial: Hypothesis<S, CAPACITY, SEGMENTS>,
    pub(super) is_trying: bool,
    pub(super) hidden_brakes: HiddenBrakes,
    /// How the force is in doubt up to the newest cell.
    pub(super) newest_doubt: DoubtFinder,
    pub(super) newest: State<S>,
    /// The state before this cell, as the last update had it.
    pub(super) recent: State<S>,
    pub(super) recent_from: usize,
    pub(super) undecided_variance: f32,
    pub(super) live_slope: f32,
    /// Smoothed cells. The first one is that before the first cell that waits.
    pub(super) smoothed: [SmoothedCell; SMOOTHED_CELLS],
    /// The first cell of the window whose lagged estimate is not due yet.
    pub(super) given: usize,
    /// Of the smoothed cells, the next one to be fetched, and the end of those that may be.
    pub(super) fetched: usize,
    pub(super) finished: usize,
    pub(super) checkpoints: Vec<State<S>, BLOCKS>,
    pub(super) records: Vec<Record<S>, BLOCK_CELLS>,
    pub(super) work: Work,
    pub(super) pass: Pass<S>,
    pub(super) past_steps: PastSteps<S>,
    pub(super) has_begun: bool,
    /// Whether variances are inferred.
    pub(super) infers: bool,
}

/// A slope of the road with its variance.
pub type Slope = Moments<f32>;

/// What the window says of the end of a cell.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SmoothedCell {
    /// The slope of the road.
    pub slope: Slope,
    /// The altitude above the origin, m.
    pub altitude: Slope,
    /// What disagrees there: which variance has opened.
    pub disagreement: Disagreement,
}

/// A live estimate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LiveSlope {
    /// The slope of the road.
    pub slope: Slope,
    /// What disagrees there.
    pub disagreement: Disagreement,
    /// Whether an altitude was used; `None` if there was none.
    pub used_altitude: Option<bool>,
    /// Whether a slope that was measured directly was used; `None` if there was none.
    pub used_slope: Option<bool>,
    /// Whether the speed stepped by more than any force can make it.
    pub speed_steps: bool,
    /// Whether the window started anew: a number was lost.
    pub restarted: bool,
}

impl SmoothedCell {
    pub(super) const NONE: Self = Self {
        slope: Slope::NONE,
        altitude: Slope::NONE,
        disagreement: Disagreement::NONE,
    };
}

impl<S: Scalar> Window<S> {
    /// Creates the window before the first cell.
    #[must_use]
    #[inline(always)] // See Estimator::new_in().
    pub fn new() -> Self {
        Self {
            cells: Vec::new(),
            adopted: Hypothesis::new(false),
            trial: Hypothesis::new(true),
            is_trying: false,
            hidden_brakes: HiddenBrakes::NONE,
            newest_doubt: DoubtFinder::new(false),
            newest: State::ZERO,
            recent: State::ZERO,
            recent_from: 0,
            undecided_variance: 0.0,
            live_slope: 0.0,
            smoothed: [SmoothedCell::NONE; SMOOTHED_CELLS],
            given: 0,
            fetched: 0,
            finished: 0,
            checkpoints: Vec::new(),
            records: Vec::new(),
            work: Work::None,
            pass: Pass::done(),
            past_steps: PastSteps::new(),
            has_begun: false,
            infers: S::INFERS && WITH_WINDOW,
        }
    }

    /// Leaves the variances as they are assumed. The lagged estimate is then the live one.
    pub const fn without_inference(&mut self) {
        self.infers = false;
    }

    /// Returns whether variances are inferred.
    #[must_use]
    pub const fn infers(&self) -> bool {
        self.infers
    }

    /// Starts with what an earlier drive has learned, before the first cell: the levels, as sums that
    /// count for some cells, and whether the bus hides brakes.
    pub fn resume(&mut self, past: LevelSums, hides_brakes: bool, numbers: &Numbers) {
        self.adopted.past = past;
        self.adopted.levels = past.levels(numbers);
        self.adopted.doubt.overrun_is_doubtful = hides_brakes;
        self.newest_doubt.overrun_is_doubtful = hides_brakes;
    }

    /// Returns the levels so far.
    #[must_use]
    pub const fn levels(&self) -> &Levels {
        &self.adopted.levels
    }

    /// Returns the state behind the newest cell; `None` before the first.
    #[must_use]
    pub const fn newest(&self) -> Option<&State<S>> {
        if self.has_begun {
            Some(&self.newest)
        } else {
            None
        }
    }

    /// Returns whether overrun counts as doubtful: brakes act that no signal reports.
    #[must_use]
    pub const fn hides_brakes(&self) -> bool {
        self.adopted.doubt.overrun_is_doubtful
    }

    /// Leaves all cells behind: what is known of them is in the newest state.
    pub(super) fn leave_all(&mut self) {
        self.adopted.committed = self.newest;
        self.adopted.doubt = self.newest_doubt;
        self.clear();
    }

    pub(super) fn clear(&mut self) {
        self.cells.clear();
        self.adopted.clear();
        (self.given, self.recent_from) = (0, 0);
        self.past_steps.clear();
        self.end_trial();
        (self.work, self.pass) = (Work::None, Pass::done());
    }

    /// Takes the newest state of an update, if it is sound.
    #[inline(never)] // One copy: flash is small.
    pub(super) fn take_newest(&mut self, newest: State<S>) {
        if newest.is_sound() {
            self.newest = newest;
        }
    }
}

impl<S: Scalar> Default for Window<S> {
    fn default() -> Self {
        Self::new()
    }
}

/// Returns what a doubtful force, %, says in a cell.
#[must_use]
pub fn of_doubtful_force(numbers: &Numbers, cell: &CellInput, force_percent: f32) -> Disagreement {
    // That of a reported retarder is no disagreement.
    let doubts = force_percent.abs() > numbers.inconsistent_percent
        && !cell.retards(numbers)
        && !cell.marks.by_accelerometer;
    let overruns = cell.marks.overrun;
    Disagreement {
        brake: doubts && overruns,
        torque: doubts && !overruns && cell.rest_percent > 0.0,
        ..Disagreement::NONE
    }
}

/// Returns whether a step is neither certain nor excluded that would move the slope.
pub(super) const fn is_undecided(numbers: &Numbers, variance: f32) -> bool {
    let least = numbers.inconsistent_percent;
    variance > least * least
}

/// Returns the variance of a slope by the age of the signals: the road behind the vehicle bends, %².
/// The slope rate is in %/m.
#[must_use]
pub const fn timing_variance(numbers: &Numbers, speed_mps: f32, slope_rate: f32) -> f32 {
    let off = numbers.timing_s * speed_mps * slope_rate;
    off * off
}
