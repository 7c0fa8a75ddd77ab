//! From samples to cells: the filter, the window behind it, and the cells that wait for their lag.

use super::waiting::{Waiting, WaitingCell};
use crate::cell::{CELL_LENGTH_M, Cell, CellEnd, Disagreement, Estimate, Live};
use crate::context::Context;
use crate::counters::{count, count_by};
use crate::delay::Delay;
use crate::filter::{CellInput, ModelMass, Quantity, SlowStates, VehicleCells, initial_state};
use crate::inference::window::{LiveSlope, Slope, Window, timing_variance};
use crate::persistent_state::PersistentState;
use crate::sample::Sample;
use crate::scalar::Scalar;

/// Usual sigma of a live slope over that of a lagged one.
const LIVE_SIGMAS: f32 = 2.0;

/// The part of the estimator behind the sampler: samples in, cells out.
#[derive(Clone, Debug)]
pub struct CellEstimator<S> {
    cells: VehicleCells,
    /// What an earlier drive has left.
    known: Option<SlowStates>,
    window: Window<S>,
    waiting: Waiting,
    end: CellEnd,
    live: Slope,
    disagreement: Disagreement,
}

impl<S: Scalar> CellEstimator<S> {
    /// Creates it before the first sample.
    #[must_use]
    #[inline(always)] // See Estimator::new_in().
    pub fn new() -> Self {
        Self {
            cells: VehicleCells::new(),
            known: None,
            window: Window::new(),
            waiting: Waiting::new(),
            end: CellEnd::default(),
            live: Slope::NONE,
            disagreement: Disagreement::NONE,
        }
    }

    /// Starts with what an earlier drive has left, before the first sample.
    pub fn resume(&mut self, context: &Context, state: &PersistentState) {
        self.known = Some(*state.slow_states());
        self.cells.resume(state.delays().altitude);
        let sums = state.levels().sums(context.tuning.prior.kept_level_cells);
        let numbers = &context.tuning.estimation;
        self.window.resume(sums, state.hides_brakes(), numbers);
    }

    /// Leaves the variances as they are assumed. The lagged estimate is then the live one.
    #[must_use]
    pub const fn without_inference(mut self) -> Self {
        self.window.without_inference();
        self
    }

    /// Does a share of the work on the lagged estimates. Returns false if nothing is left to do.
    pub fn work(&mut self, context: &Context) -> bool {
        let is_busy = self.window.is_busy();
        if is_busy {
            self.window.work(&context.tuning.estimation);
        }
        is_busy
    }

    /// Moves over the cell of a sample. No [work](Self::work) may be left. Returns false while there is
    /// no speed yet.
    pub fn push(&mut self, context: &mut Context, sample: &Sample) -> bool {
        let numbers = &context.tuning.estimation;
        let Some(cell) = self
            .cells
            .next(numbers, context, sample, self.known.as_ref())
        else {
            return false;
        };
        let doubt_behind = self.cells.doubt_behind(&context.tuning, sample);
        let prior = || initial_state(self.known.as_ref(), context, sample, &cell);
        let live = self
            .window
            .push(numbers, &cell, doubt_behind.as_ref(), prior);
        self.give_up_unfetched(context);
        count_events(context, &cell, &live);
        self.take_live(context, sample, &live);
        true
    }

    /// Moves over the cell of a sample, and does all work that follows, for callers that are not
    /// pressed for time.
    pub fn push_and_work(&mut self, context: &mut Context, sample: &Sample) -> bool {
        let moved = self.push(context, sample);
        while self.work(context) {}
        moved
    }

    /// An update overwrites the finished cells that were not fetched.
    fn give_up_unfetched(&mut self, context: &mut Context) {
        if self.window.is_busy() {
            let unfetched = self.window.drop_unfetched();
            for _ in 0..unfetched {
                self.waiting.pop();
            }
            count_by(&mut context.counters.cells_lost, unfetched);
        }
    }

    fn take_live(&mut self, context: &mut Context, sample: &Sample, live: &LiveSlope) {
        self.end = sample.end;
        self.live = live.slope;
        let least_percent = LIVE_SIGMAS * context.tuning.estimation.inconsistent_percent;
        self.disagreement = live
            .disagreement
            .where_uncertain(live.slope.variance, least_percent)
            .or(sample.disagreement);
        if live.restarted {
            self.waiting.give_up();
        }
        let lost = self.waiting.push(WaitingCell {
            end: self.end,
            live: live.slope,
            live_consistent: self.disagreement.is_none(),
            signals_agree: sample.disagreement.is_none(),
        });
        self.waiting.mark(sample.disagreeing_cells.into());
        if !self.window.infers() || live.restarted {
            self.waiting.give_up();
        }
        count_by(&mut context.counters.cells_lost, usize::from(lost));
    }

    /// Returns the estimate at the end of the newest cell; `None` before the first.
    #[must_use]
    pub fn live(&self, context: &Context, sample: &Sample) -> Option<Live> {
        let state = self.window.newest()?;
        let of = |quantity| state.quantity(quantity).0.to_single().uncertain();
        let scale = of(Quantity::Scale).plus(1.0);
        let energy = state.quantity(Quantity::KineticEnergy).0.mean.to_f32();
        let altitude = |origin_m| of(Quantity::Altitude).plus(origin_m);
        Some(Live {
            end: self.end,
            estimate: Estimate {
                grade_percent: self.live.grade(),
                altitude_m: self.cells.origin_m().map(altitude),
                speed_mps: Scalar::sqrt(Scalar::max(0.0, 2.0 * energy)),
                bias_percent: of(Quantity::ModelError),
                scale,
                mass_kg: ModelMass::of(context, sample).gross_kg(scale),
            },
            disagreement: self.disagreement,
        })
    }

    /// Returns the next finished cell, whose lag is over.
    #[inline(never)] // Called from several places.
    pub fn next_cell(&mut self, context: &mut Context) -> Option<Cell> {
        let cell = if self.waiting.has_given_up() {
            self.waiting.pop()?.unsmoothed()
        } else {
            let (mut smoothed, before) = self.window.next_finished()?;
            let waiting = self.waiting.pop()?;
            let rate = (smoothed.slope.mean - before) / CELL_LENGTH_M;
            let numbers = &context.tuning.estimation;
            let timing = timing_variance(numbers, waiting.end.speed_mps, rate);
            smoothed.disagreement = smoothed
                .disagreement
                .where_uncertain(smoothed.slope.variance, numbers.inconsistent_percent);
            waiting.smoothed(&smoothed, timing, self.cells.origin_m())
        };
        let counters = &mut context.counters;
        if !cell.lagged_consistent {
            count(&mut counters.cells_suspect);
        }
        if !(cell.lagged_grade_percent.value + cell.lagged_grade_percent.sigma).is_finite() {
            count(&mut counters.cells_unsound);
        }
        Some(cell)
    }

    /// Begins the work at the end of a drive. Returns false if none is left.
    pub fn begin_end(&mut self, context: &mut Context) -> bool {
        let begins = self.window.begin_end(&context.tuning.estimation);
        self.give_up_unfetched(context);
        begins
    }

    /// Returns the next of the last cells of a drive, with all work that it needs.
    pub fn drain_cell(&mut self, context: &mut Context) -> Option<Cell> {
        loop {
            let cell = self.next_cell(context);
            if cell.is_some() || !(self.work(context) || self.begin_end(context)) {
                return cell;
            }
        }
    }

    /// Returns what an earlier drive has left; `None` without one.
    #[must_use]
    pub const fn known(&self) -> Option<&SlowStates> {
        self.known.as_ref()
    }

    /// Returns the states that belong to the vehicle, learned with this mass in kg; `None` before the
    /// first cell.
    #[must_use]
    pub fn slow_states(&self, mass_kg: f32) -> Option<SlowStates> {
        let state = self.window.newest()?;
        Some(SlowStates::of(state, mass_kg))
    }

    /// Returns the low-pass of the receiver, as the drive shows it.
    #[must_use]
    pub const fn altitude_delay(&self) -> Delay {
        self.cells.altitude_delay()
    }

    /// Returns the window behind the vehicle.
    #[must_use]
    pub const fn window(&self) -> &Window<S> {
        &self.window
    }
}

impl<S: Scalar> Default for CellEstimator<S> {
    fn default() -> Self {
        Self::new()
    }
}

fn count_events(context: &mut Context, cell: &CellInput, live: &LiveSlope) {
    let counters = &mut context.counters;
    counters.steps += 1;
    let events = [
        (&mut counters.invalid_steps, cell.marks.invalid),
        (
            &mut counters.altitudes_used,
            live.used_altitude == Some(true),
        ),
        (
            &mut counters.altitudes_rejected,
            live.used_altitude == Some(false),
        ),
        (&mut counters.slopes_used, live.used_slope == Some(true)),
        (
            &mut counters.slopes_rejected,
            live.used_slope == Some(false),
        ),
        (&mut counters.speed_steps, live.speed_steps),
        (
            &mut counters.loads_reopened,
            cell.load_variance > 0.0 && !cell.marks.gap,
        ),
        (&mut counters.restarts, live.restarted),
    ];
    for (counter, has_happened) in events {
        if has_happened {
            count(counter);
        }
    }
}
