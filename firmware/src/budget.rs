//! The cost of the estimator on the board: instructions and stack for a recorded drive.
//!
//! The drive runs three times: through the estimator, with the calls that a program makes; through
//! its parts, so that the filter and the smoother are counted separately; and with the map in flash.
//! [`memory_budget`](crate::memory_budget) adds the road memory.

use crate::counted::{BudgetError, create, tuning};
use crate::map_region;
use crate::memory_budget::{FLASH_BYTES, MemoryBudget};
use crate::meter::{CountTally, InstructionMeter, depth};
use crate::on_map::OnMap;
use crate::recorded::{Recorded, Unusable};
use core::fmt;
use core::mem::MaybeUninit;
use estimator_core::filter::{Filter, SensorNoiseRatios};
use estimator_core::smoother::fixed_lag::{BLOCK_CELLS, FixedLag, LAG_CELLS};
use estimator_core::{Context, Estimator, Instant, Intake, Sampler, Scalar, Step};
use static_cell::StaticCell;

/// Number of steps until the lag is full and each new block of cells finishes another block.
const FILLING_STEPS: u32 = (LAG_CELLS + BLOCK_CELLS) as u32;

/// The counts of one scalar type.
#[derive(Clone, Copy, Debug, Default)]
pub struct Budget {
    estimator_bytes: usize,
    /// Of its creation in its place.
    start_stack_bytes: usize,
    stack_bytes: usize,
    ignored_frame: CountTally,
    relevant_frame: CountTally,
    /// A call of `step` and the cells fetched after it.
    cell: CountTally,
    /// A filter step with both measurements.
    full_step: CountTally,
    /// A filter step with any measurements.
    step: CountTally,
    /// The work of the smoother for a cell when the lag is full.
    lag: CountTally,
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
    /// A share of the work at the end of the drive, and the cells fetched after it.
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
    budget.through_parts::<S>(meter)?;
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
            let (moved, count) = meter.count(|| {
                let moved = estimator.drain_step();
                while estimator.next_cell().is_some() {}
                moved
            })?;
            self.drain.add(count);
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
            let (moved, count) = meter.count(|| {
                let moved = estimator.step().is_some();
                while estimator.next_cell().is_some() {}
                moved
            })?;
            if !moved {
                return Ok(());
            }
            self.cell.add(count);
            let (_, count) = meter.count(|| estimator.live())?;
            self.live.add(count);
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
        if let (Step::Moved(_), Some(live)) = (step, estimator.live()) {
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
            &self.cell,
            &self.live,
            &self.persistent_state,
            &self.drain,
        ];
        calls.map(CountTally::worst).into_iter().max().unwrap_or(0)
    }

    /// Counts the filter and the smoother separately, on the same drive.
    fn through_parts<S: Scalar>(
        &mut self,
        meter: &mut InstructionMeter,
    ) -> Result<(), BudgetError> {
        let (model, mut drive) = Recorded::open()?;
        let mut context = Context::new(model, tuning()).map_err(Unusable::Vehicle)?;
        let mut intake = Intake::new(&context.tuning);
        let mut sampler = Sampler::new();
        let mut filter = Filter::<S>::new(&context.tuning, &SensorNoiseRatios::default(), None);
        let mut lag = FixedLag::<S>::new();
        let mut steps = 0;
        // Whole blocks only. The work is at the end of a block, so the mean over a part of it would
        // be wrong.
        let mut block_of_lag = CountTally::default();
        loop {
            let block = drive.next_block()?;
            if block.len() == 0 {
                return Ok(());
            }
            for frame in block {
                let (time, frame) = frame?;
                intake.on_frame(&mut context, time, &frame, &mut sampler);
                while let Some(sample) = sampler.next_sample() {
                    let (record, count) = meter.count(|| filter.step(&mut context, &sample))?;
                    self.step.add(count);
                    let (Some(record), Some(state)) = (record, filter.state()) else {
                        continue;
                    };
                    let updates = &record.smoother_input;
                    if updates.speed.is_some() && updates.altitude().is_some() {
                        self.full_step.add(count);
                    }
                    let (_, count) = meter.count(|| {
                        lag.push(&record, state);
                        while lag.next_cell().is_some() {}
                    })?;
                    steps += 1;
                    if steps > FILLING_STEPS {
                        block_of_lag.add(count);
                    }
                    if block_of_lag.calls() == BLOCK_CELLS as u32 {
                        self.lag.add_all(&block_of_lag);
                        block_of_lag = CountTally::default();
                    }
                }
            }
        }
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
            ("lag", &self.lag),
            ("cell", &self.cell),
            ("live", &self.live),
        ] {
            writeln!(f, "{name}_mean {}", tally.mean())?;
            writeln!(f, "{name}_worst {}", tally.worst())?;
        }
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
