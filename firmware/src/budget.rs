//! The cost of the estimator on the board: instructions and stack for a recorded drive.
//!
//! The drive runs twice: through the estimator, with the calls that a program makes; and with the map in
//! flash.
//! [`memory_budget`](crate::memory_budget) adds the road memory.

use crate::counted::{BudgetError, create};
use crate::map_region;
use crate::memory_budget::{FLASH_BYTES, MemoryBudget};
use crate::meter::{CountTally, InstructionMeter, depth};
use crate::on_map::OnMap;
use crate::recorded::{Recorded, Unusable};
use core::fmt;
use core::mem::MaybeUninit;
use estimator_core::inference::window::WINDOW_CELLS;
use estimator_core::{Estimator, Instant, Sample, Scalar, Step};
use static_cell::StaticCell;

/// Number of steps until the window is full.
const FILLING_STEPS: u32 = WINDOW_CELLS as u32;

/// The counts of one scalar type.
#[derive(Clone, Copy, Debug, Default)]
pub struct Budget {
    estimator_bytes: usize,
    /// Of its creation in its place.
    start_stack_bytes: usize,
    stack_bytes: usize,
    ignored_frame: CountTally,
    relevant_frame: CountTally,
    /// A call of `step` that moves over a cell.
    step: CountTally,
    /// The same with both measurements.
    full_step: CountTally,
    /// A call of `step` that does a share of the smoothing.
    share: CountTally,
    /// The fetching of a finished cell.
    fetch: CountTally,
    /// The smoothing that follows a cell when the window is full.
    lag: CountTally,
    /// All calls of a cell.
    cell: CountTally,
    /// The live estimate.
    live: CountTally,
    on_map_bytes: usize,
    map_stack_bytes: usize,
    /// Place on the map and grade with it, after a step.
    map_step: CountTally,
    /// A finished cell against the map.
    map_finish: CountTally,
    /// A part of the road ahead.
    ahead: CountTally,
    /// What the drive leaves for the next one, as bytes.
    persistent_state: CountTally,
    /// A share of the work at the end of the drive.
    drain: CountTally,
    memory: MemoryBudget,
}

/// Counts in this scalar type.
///
/// # Errors
/// The drive is unusable, or a call is too long to count.
///
/// # Panics
/// Panics if the place is taken.
pub fn run<S: Scalar>(
    meter: &mut InstructionMeter,
    place: &'static StaticCell<Estimator<S>>,
    flash: &mut [u8; FLASH_BYTES],
) -> Result<Budget, BudgetError> {
    let mut budget = Budget {
        estimator_bytes: size_of::<Estimator<S>>(),
        on_map_bytes: size_of::<OnMap<'_>>(),
        ..Budget::default()
    };
    let place = place.uninit();
    budget.through_estimator(meter, place, None)?;
    let mut on_map = OnMap::new(map_region::open().map_err(BudgetError::Map)?);
    let mut with_map = Budget::default();
    with_map.through_estimator(meter, place, Some(&mut on_map))?;
    budget.map_stack_bytes = with_map.stack_bytes;
    budget.map_step = with_map.map_step;
    budget.map_finish = with_map.map_finish;
    budget.ahead = with_map.ahead;
    budget.memory = MemoryBudget::run(meter, place, flash)?;
    Ok(budget)
}

impl Budget {
    /// Counts the calls of a program that uses the estimator, with a map or without.
    fn through_estimator<S: Scalar>(
        &mut self,
        meter: &mut InstructionMeter,
        place: &mut MaybeUninit<Estimator<S>>,
        mut on_map: Option<&mut OnMap<'_>>,
    ) -> Result<(), BudgetError> {
        let (model, mut drive) = Recorded::open()?;
        let (estimator, bytes) = depth(|| create(place, &model));
        let estimator = estimator.map_err(Unusable::Vehicle)?;
        self.start_stack_bytes = bytes;
        loop {
            let block = drive.next_block()?;
            let is_end = block.len() == 0;
            let (done, bytes) = depth(|| {
                for frame in block {
                    let (time, frame) = frame?;
                    match on_map.as_deref_mut() {
                        None => self.frame(meter, estimator, time, &frame)?,
                        Some(on_map) => {
                            estimator.on_frame(time, &frame);
                            while self.step_on_map(meter, estimator, on_map)? {}
                        }
                    }
                }
                if is_end && on_map.is_none() {
                    self.end(meter, estimator)?;
                }
                Ok::<(), BudgetError>(())
            });
            done?;
            self.stack_bytes = self.stack_bytes.max(bytes);
            if is_end {
                return Ok(());
            }
        }
    }

    /// Counts the calls at the end of a drive.
    fn end<S: Scalar>(
        &mut self,
        meter: &mut InstructionMeter,
        estimator: &mut Estimator<S>,
    ) -> Result<(), BudgetError> {
        let (_, count) = meter.count(|| {
            let state = estimator.persistent_state();
            state.map(|state| state.to_bytes())
        })?;
        self.persistent_state.add(count);
        loop {
            let (moved, count) = meter.count(|| estimator.drain_step())?;
            self.drain.add(count);
            self.fetch(meter, estimator)?;
            if !moved {
                return Ok(());
            }
        }
    }

    fn frame<S: Scalar>(
        &mut self,
        meter: &mut InstructionMeter,
        estimator: &mut Estimator<S>,
        time: Instant,
        frame: &impl embedded_can::Frame,
    ) -> Result<(), BudgetError> {
        let ignored_before = estimator.counters().frames_ignored;
        let (_, count) = meter.count(|| estimator.on_frame(time, frame))?;
        if estimator.counters().frames_ignored > ignored_before {
            self.ignored_frame.add(count);
        } else {
            self.relevant_frame.add(count);
        }
        loop {
            let (step, count) = meter.count(|| estimator.step())?;
            self.fetch(meter, estimator)?;
            match step {
                None => return Ok(()),
                Some(Step::Smoothed) => self.share(count),
                Some(Step::Moved | Step::Skipped) => self.moved(count, estimator.sample()),
            }
            let (_, count) = meter.count(|| estimator.live())?;
            self.live.add(count);
        }
    }

    /// Counts the fetching of each finished cell.
    fn fetch<S: Scalar>(
        &mut self,
        meter: &mut InstructionMeter,
        estimator: &mut Estimator<S>,
    ) -> Result<(), BudgetError> {
        loop {
            let (cell, count) = meter.count(|| estimator.next_cell())?;
            if cell.is_none() {
                return Ok(());
            }
            self.fetch.add(count);
            if self.step.calls() > FILLING_STEPS {
                self.cell.add_to_last(count);
            }
        }
    }

    fn moved(&mut self, count: u32, sample: Option<&Sample>) {
        self.step.add(count);
        if sample.is_some_and(|sample| sample.speed.is_some() && sample.altitude.is_some()) {
            self.full_step.add(count);
        }
        if self.step.calls() > FILLING_STEPS {
            self.lag.add(0);
            self.cell.add(count);
        }
    }

    fn share(&mut self, count: u32) {
        self.share.add(count);
        if self.step.calls() > FILLING_STEPS {
            self.lag.add_to_last(count);
            self.cell.add_to_last(count);
        }
    }

    /// Counts what the map adds to a step, and to the cells that it finishes.
    fn step_on_map<S: Scalar>(
        &mut self,
        meter: &mut InstructionMeter,
        estimator: &mut Estimator<S>,
        on_map: &mut OnMap<'_>,
    ) -> Result<bool, BudgetError> {
        let Some(step) = estimator.step() else {
            return Ok(false);
        };
        if let (Step::Moved, Some(live)) = (step, estimator.live()) {
            let (_, count) = meter.count(|| on_map.advance(&live))?;
            self.map_step.add(count);
            let (_, count) = meter.count(|| on_map.next_part(&live))?;
            self.ahead.add(count);
        }
        while let Some(cell) = estimator.next_cell() {
            let (_, count) = meter.count(|| on_map.finish(&cell))?;
            self.map_finish.add(count);
        }
        Ok(true)
    }

    /// Returns the largest count of a call that a program makes during a drive and at its end.
    fn worst_call(&self) -> u32 {
        let calls = [
            &self.ignored_frame,
            &self.relevant_frame,
            &self.step,
            &self.share,
            &self.fetch,
            &self.live,
            &self.persistent_state,
            &self.drain,
        ];
        calls.map(CountTally::worst).into_iter().max().unwrap_or(0)
    }
}

/// Prints one figure a line, name and number.
impl fmt::Display for Budget {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "estimator_bytes {}", self.estimator_bytes)?;
        writeln!(f, "start_stack_bytes {}", self.start_stack_bytes)?;
        writeln!(f, "stack_bytes {}", self.stack_bytes)?;
        writeln!(f, "on_map_bytes {}", self.on_map_bytes)?;
        writeln!(f, "map_stack_bytes {}", self.map_stack_bytes)?;
        for (name, tally) in [
            ("map_step", &self.map_step),
            ("map_finish", &self.map_finish),
            ("ahead", &self.ahead),
            ("ignored_frame", &self.ignored_frame),
            ("relevant_frame", &self.relevant_frame),
            ("full_step", &self.full_step),
            ("step", &self.step),
            ("share", &self.share),
            ("live", &self.live),
        ] {
            writeln!(f, "{name}_mean {}", tally.mean())?;
            writeln!(f, "{name}_worst {}", tally.worst())?;
        }
        writeln!(f, "lag_mean {}", self.lag.mean())?;
        writeln!(f, "cell_mean {}", self.cell.mean())?;
        writeln!(f, "persistent_state {}", self.persistent_state.worst())?;
        writeln!(f, "drain_worst {}", self.drain.worst())?;
        writeln!(f, "call_worst {}", self.worst_call())?;
        self.memory.fmt(f)
    }
}

impl fmt::Display for BudgetError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Drive(unusable) => write!(f, "{unusable}"),
            Self::Count(uncountable) => write!(f, "{uncountable}"),
            Self::Map(error) => write!(f, "the map in flash: {error}"),
            Self::Memory(error) => write!(f, "the road memory: {error}"),
        }
    }
}
