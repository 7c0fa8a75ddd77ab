//! The cost of the estimator on the board: instructions and stack for a recorded drive.
//!
//! The drive runs three times: through the estimator, with the calls that a program makes; through
//! its parts, so that the filter and the smoother are counted separately; and with the map in flash.

use crate::map_region;
use crate::meter::{CountTally, InstructionMeter, Uncountable, depth};
use crate::on_map::OnMap;
use crate::recorded::{Recorded, Unusable};
use core::fmt;
use estimator_core::filter::{Filter, SensorNoiseRatios};
use estimator_core::roadmap::MapError;
use estimator_core::smoother::fixed_lag::{BLOCK_CELLS, FixedLag, LAG_CELLS};
use estimator_core::{Context, Estimator, Instant, Intake, Sampler, Scalar, Step, Tuning};

/// Number of steps until the lag is full and each new block of cells finishes another block.
const FILLING_STEPS: u32 = (LAG_CELLS + BLOCK_CELLS) as u32;

/// The counts of one scalar type.
#[derive(Clone, Copy, Debug, Default)]
pub struct Budget {
    estimator_bytes: usize,
    /// Without the estimator itself, which may be created in place.
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
}

/// Why nothing was counted.
#[derive(Debug)]
pub enum BudgetError {
    /// The drive cannot be used.
    Drive(Unusable),
    /// Instructions cannot be counted.
    Count(Uncountable),
    /// There is no usable map in flash.
    Map(MapError),
}

impl From<Uncountable> for BudgetError {
    fn from(uncountable: Uncountable) -> Self {
        Self::Count(uncountable)
    }
}

impl From<Unusable> for BudgetError {
    fn from(unusable: Unusable) -> Self {
        Self::Drive(unusable)
    }
}

/// Counts in this scalar type.
///
/// # Errors
/// The drive is unusable, or a call is too long to count.
pub fn run<S: Scalar>(meter: &mut InstructionMeter) -> Result<Budget, BudgetError> {
    let mut budget = Budget {
        estimator_bytes: size_of::<Estimator<S>>(),
        on_map_bytes: size_of::<OnMap<'_>>(),
        ..Budget::default()
    };
    budget.through_estimator::<S>(meter, None)?;
    budget.through_parts::<S>(meter)?;
    let mut on_map = OnMap::new(map_region::open().map_err(BudgetError::Map)?);
    let mut with_map = Budget::default();
    with_map.through_estimator::<S>(meter, Some(&mut on_map))?;
    budget.map_stack_bytes = with_map.stack_bytes;
    budget.map_step = with_map.map_step;
    budget.map_finish = with_map.map_finish;
    budget.ahead = with_map.ahead;
    Ok(budget)
}

impl Budget {
    /// Counts the calls of a program that uses the estimator, with a map or without. In one function:
    /// only so does the compiler build the estimator in its place.
    fn through_estimator<S: Scalar>(
        &mut self,
        meter: &mut InstructionMeter,
        mut on_map: Option<&mut OnMap<'_>>,
    ) -> Result<(), BudgetError> {
        let (model, mut drive) = Recorded::open()?;
        let (estimator, start_stack_bytes) =
            depth(|| Estimator::<S>::new(model, Tuning::default()));
        let mut estimator = estimator.map_err(Unusable::Vehicle)?;
        self.start_stack_bytes = start_stack_bytes;
        loop {
            let block = drive.next_block()?;
            if block.len() == 0 {
                return Ok(());
            }
            let (done, stack_bytes) = depth(|| {
                for frame in block {
                    let (time, frame) = frame?;
                    match on_map.as_deref_mut() {
                        None => self.frame(meter, &mut estimator, time, &frame)?,
                        Some(on_map) => {
                            estimator.on_frame(time, &frame);
                            while self.step_on_map(meter, &mut estimator, on_map)? {}
                        }
                    }
                }
                Ok::<(), BudgetError>(())
            });
            done?;
            self.stack_bytes = self.stack_bytes.max(stack_bytes);
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

    /// Counts the filter and the smoother separately, on the same drive.
    fn through_parts<S: Scalar>(
        &mut self,
        meter: &mut InstructionMeter,
    ) -> Result<(), BudgetError> {
        let (model, mut drive) = Recorded::open()?;
        let mut context = Context::new(model, Tuning::default()).map_err(Unusable::Vehicle)?;
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
        Ok(())
    }
}

impl fmt::Display for BudgetError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Drive(unusable) => write!(f, "{unusable}"),
            Self::Count(uncountable) => write!(f, "{uncountable}"),
            Self::Map(error) => write!(f, "the map in flash: {error}"),
        }
    }
}
