//! Smoothing of a whole run.
//!
//! The samples pass the core's filter a second time, in double precision and with the final
//! estimate of the sensor noise from the first pass. The core's backward pass then runs over the
//! whole run.
//!
//! The records of all cells are not kept in memory. The run is divided into parts, and the filter
//! state before each part is stored. On a backward pass each part is filtered again from there. A
//! part that is still too long is divided again (A. Griewank, "Achieving logarithmic growth of
//! temporal and spatial complexity in reverse automatic differentiation", Optimization Methods and
//! Software 1:35, 1992). There are two backward passes: one looks for steps of the model's error,
//! and one makes the estimates. The filter therefore runs three times over up to 41 km, and twice
//! more for each factor of 32. Memory, [`held_bytes`], grows by the same steps. The results equal
//! those of a smoother that keeps everything, bit for bit.

use super::disagreements::Disagreements;
use super::drifts::Drifts;
use super::filtered_cell::ForwardCell;
use super::misfit::Misfit;
use super::model_steps::{Forces, ModelSteps};
use super::samples::Samples;
use super::stuck_torques::StuckTorques;
use estimator_core::cell::CellEnd;
use estimator_core::filter::{Filter, ModelMass, StepRecord};
use estimator_core::sample::Sample;
use estimator_core::smoother::BackwardPass;
use estimator_core::{Context, Counters, Estimate, Model, Scalar, Tuning};
use std::ops::Range;

/// Largest number of cells in a part whose records are held.
const RECORDS: usize = 512;
/// Number of parts that a longer one is divided into.
const PARTS: usize = 32;
/// Largest number of times that steps of the model's error are looked for.
const SEARCHES: usize = 8;

/// A cell of a smoothed run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SmoothedCell {
    /// End of the cell: distance and time.
    pub end: CellEnd,
    /// The estimate there, from all measurements of the run.
    pub estimate: Estimate,
    /// Whether nothing disagrees here, as far as the whole run tells.
    pub is_consistent: bool,
}

/// Smooths a run. Returns one cell for each sample from the first speed on. `filter` is that of the
/// second pass ([`Filter::second_pass`]).
///
/// When the filter finds that the torque is stuck, it has already used it for some hundred metres. It
/// then runs over the drive once more, without that torque from where it came to rest.
///
/// When the filter detects a drift of GNSS, it has already followed it for some hundred metres. The
/// filter then runs over the drive twice more: without the fixes since the drift began, and with
/// all of them. The second case is needed because wrong vehicle parameters have the same symptoms
/// in the first kilometres. The pass with the larger likelihood of the altitudes counts.
///
/// Where the error of the model steps, the filter needs kilometres to be certain. A backward pass finds
/// such steps, and the filter runs over the drive again and allows for them.
#[must_use]
pub fn smooth_run<S: Scalar>(
    model: &Model,
    tuning: &Tuning,
    filter: &Filter<S>,
    samples: &[Sample],
) -> Vec<SmoothedCell> {
    let mut segments = Vec::new();
    let Ok(_) = smooth_segments(model, tuning, filter, &mut { samples }, |_, segment| {
        segments.push(segment);
        Ok(())
    });
    segments.into_iter().rev().flatten().collect()
}

/// Smooths a run that need not fit into memory, from its end to its start. `take` gets one segment
/// after the other. The cells of a segment are in the order of the run; the index is that of the
/// first one. Returns where signals disagree in the pass that counts.
///
/// # Errors
/// Returns the error of `samples` or of `take`.
pub fn smooth_segments<S: Scalar, M: Samples>(
    model: &Model,
    tuning: &Tuning,
    filter: &Filter<S>,
    samples: &mut M,
    take: impl FnMut(usize, Vec<SmoothedCell>) -> Result<(), M::Error>,
) -> Result<Disagreements, M::Error> {
    let mut smoother = Smoother {
        context: Context {
            model: model.clone(),
            tuning: tuning.clone(),
            counters: Counters::default(),
        },
        start: Checkpoint {
            filter: filter.clone(),
            has_drifted: false,
            torque_is_stuck: false,
            cells: 0,
        },
        samples,
        drifts: Drifts::default(),
        stuck_torques: StuckTorques::default(),
        steps: ModelSteps::default(),
        take,
    };
    let first = smoother.look_for_stuck_torques()?;
    let first = smoother.compare_drifts(first)?;
    let Look {
        parts,
        disagreements,
        ..
    } = smoother.look_for_steps(first)?;
    smoother.go_back(
        &parts,
        &mut BackwardPass::new(),
        &Purpose::Estimate(&disagreements),
    )?;
    Ok(disagreements)
}

/// Returns the memory that smoothing of so many cells takes, bytes. It grows by one level of parts
/// at 41, 1,300 and 42,000 km, and not between them.
#[must_use]
pub const fn held_bytes(cells: usize) -> usize {
    let mut levels = 0;
    let mut part = cells;
    while part > RECORDS {
        part = part.div_ceil(PARTS);
        levels += 1;
    }
    let mark = size_of::<(Range<usize>, Checkpoint<f64>)>();
    RECORDS * (size_of::<ForwardCell<f64>>() + size_of::<SmoothedCell>()) + levels * PARTS * mark
}

/// The filter before a part of the run.
#[derive(Clone)]
struct Checkpoint<S> {
    filter: Filter<S>,
    /// True if the last altitudes were rejected because of a drift.
    has_drifted: bool,
    /// True if the torque of the last cell is left out because it is stuck.
    torque_is_stuck: bool,
    /// Number of cells since the first speed.
    cells: usize,
}

/// Parts of a run in order, each with the filter before it.
type Parts<S> = Vec<(Range<usize>, Checkpoint<S>)>;

/// What the filter finds on its way over the run.
struct Look<S> {
    misfit: Misfit,
    drifts: Drifts,
    stuck_torques: StuckTorques,
    /// Where signals disagree.
    disagreements: Disagreements,
    parts: Parts<S>,
}

/// What a backward pass is for.
enum Purpose<'a> {
    /// Estimates, with the cells in which signals disagree.
    Estimate(&'a Disagreements),
    /// Steps of the model's error, but not where signals disagree.
    FindSteps(&'a Disagreements),
}

struct Smoother<'a, S, M, T> {
    context: Context,
    /// The filter before the run.
    start: Checkpoint<S>,
    samples: &'a mut M,
    /// Drifts whose altitudes are not used.
    drifts: Drifts,
    /// Torques that are not used.
    stuck_torques: StuckTorques,
    /// Steps of the model's error.
    steps: ModelSteps,
    take: T,
}

impl<S, M, T> Smoother<'_, S, M, T>
where
    S: Scalar,
    M: Samples,
    T: FnMut(usize, Vec<SmoothedCell>) -> Result<(), M::Error>,
{
    fn look_for_stuck_torques(&mut self) -> Result<Look<S>, M::Error> {
        let mut first = self.look()?;
        if first.stuck_torques.is_empty() {
            return Ok(first);
        }
        self.stuck_torques = core::mem::take(&mut first.stuck_torques);
        self.look()
    }

    /// Compares the run as the filter had it with those without and with the altitudes of its
    /// drifts. Returns the most likely one.
    fn compare_drifts(&mut self, first: Look<S>) -> Result<Look<S>, M::Error> {
        if first.drifts.is_empty() {
            return Ok(first);
        }
        let tuning = self.context.tuning.clone();
        let mut believing = tuning.clone();
        believing.gates.drift_sigmas = f32::INFINITY;
        let left_out = (first.drifts.clone(), tuning.clone());
        let mut best = ((Drifts::default(), tuning), first);
        for other in [left_out, (Drifts::default(), believing)] {
            (self.drifts, self.context.tuning) = other.clone();
            let look = self.look()?;
            if look.misfit.mean_of_altitudes() < best.1.misfit.mean_of_altitudes() {
                best = (other, look);
            }
        }
        (self.drifts, self.context.tuning) = best.0;
        Ok(best.1)
    }

    /// Looks for steps of the model's error until no other one stays.
    fn look_for_steps(&mut self, mut best: Look<S>) -> Result<Look<S>, M::Error> {
        for _ in 0..SEARCHES {
            self.go_back(
                &best.parts,
                &mut BackwardPass::new(),
                &Purpose::FindSteps(&best.disagreements),
            )?;
            let tried = self.steps.suggested();
            if tried == 0 {
                break;
            }
            self.steps.take_as_forces(Forces::Suggested);
            let with_forces = self.look()?;
            self.steps.take_as_forces(Forces::None);
            let open = self.look()?;
            let trials = [&with_forces.misfit, &open.misfit];
            match self.steps.judge(&best.misfit, trials) {
                0 => {}
                stay if stay == tried => best = open,
                _ => best = self.look()?,
            }
        }
        self.compare_sizes(best)
    }

    /// Compares the run that leaves the sizes of its steps open with that in which they are forces.
    /// Returns the more likely one.
    fn compare_sizes(&mut self, open: Look<S>) -> Result<Look<S>, M::Error> {
        if self.steps.is_empty() {
            return Ok(open);
        }
        self.steps.take_as_forces(Forces::Known);
        self.learn_levels_again()?;
        let with_forces = self.look()?;
        if with_forces.misfit.total().all < open.misfit.total().all {
            return Ok(with_forces);
        }
        self.steps.take_as_forces(Forces::None);
        Ok(open)
    }

    /// Learns how large the errors are besides their steps, and starts with it.
    fn learn_levels_again(&mut self) -> Result<(), M::Error> {
        let mut learning = self.start.clone();
        learning.filter.forget_error_levels();
        self.filter(0..self.samples.count(), &mut learning, |_, _, _| ())?;
        self.start.filter = learning.filter.second_pass(&self.context.tuning);
        Ok(())
    }

    /// Takes the filter over the run.
    fn look(&mut self) -> Result<Look<S>, M::Error> {
        let mut misfit = Misfit::default();
        let mut drifts = Drifts::default();
        let mut stuck_torques = StuckTorques::default();
        let mut disagreements = Disagreements::default();
        let (all, start) = (0..self.samples.count(), self.start.clone());
        let parts = self.divide(all, start, |record| {
            let cell = record.end.cell;
            misfit.add(cell, &record.smoother_input);
            drifts.note(record.event, cell);
            stuck_torques.note(record.event, cell);
            disagreements.note(record);
        })?;
        Ok(Look {
            misfit,
            drifts,
            stuck_torques,
            disagreements,
            parts,
        })
    }

    /// Divides a part, before which the filter was at `checkpoint`. `note` gets each step.
    fn divide(
        &mut self,
        part: Range<usize>,
        mut checkpoint: Checkpoint<S>,
        mut note: impl FnMut(&StepRecord<S>),
    ) -> Result<Parts<S>, M::Error> {
        let length = part.len().div_ceil(PARTS).max(1);
        let mut parts = Vec::with_capacity(PARTS);
        for begin in part.clone().step_by(length) {
            let within = begin..part.end.min(begin + length);
            parts.push((within.clone(), checkpoint.clone()));
            self.filter(within, &mut checkpoint, |record, _, _| note(&record))?;
        }
        Ok(parts)
    }

    /// Goes back over parts. `pass` is the backward pass behind the last of them.
    fn go_back(
        &mut self,
        parts: &[(Range<usize>, Checkpoint<S>)],
        pass: &mut BackwardPass<S>,
        purpose: &Purpose<'_>,
    ) -> Result<(), M::Error> {
        for (part, checkpoint) in parts.iter().rev() {
            let (part, checkpoint) = (part.clone(), checkpoint.clone());
            if part.len() <= RECORDS {
                self.go_back_over_records(part, checkpoint, pass, purpose)?;
            } else {
                let parts = self.divide(part, checkpoint, |_| ())?;
                self.go_back(&parts, pass, purpose)?;
            }
        }
        Ok(())
    }

    fn go_back_over_records(
        &mut self,
        part: Range<usize>,
        mut start: Checkpoint<S>,
        pass: &mut BackwardPass<S>,
        purpose: &Purpose<'_>,
    ) -> Result<(), M::Error> {
        let first = start.cells;
        let mut filtered = Vec::with_capacity(part.len());
        self.filter(part, &mut start, |record, filter, mass| {
            let state = filter.state().copied();
            filtered.extend(state.map(|state| ForwardCell {
                record,
                state,
                mass,
            }));
        })?;
        let mut smoothed = Vec::new();
        for ForwardCell {
            record,
            state,
            mass,
        } in filtered.iter().rev()
        {
            let cell = record.end.cell;
            match purpose {
                Purpose::Estimate(disagreements) => {
                    let mut estimate = pass.estimate(state, mass);
                    estimate.bias_percent.value += self.steps.sum_percent(cell);
                    smoothed.push(SmoothedCell {
                        end: record.end,
                        estimate,
                        is_consistent: !disagreements.cover(cell),
                    });
                }
                Purpose::FindSteps(disagreements) => {
                    let scale = || pass.estimate(state, mass).scale.value;
                    self.steps
                        .suggest(cell, pass.bias_step(), scale, disagreements);
                }
            }
            pass.retreat(&record.smoother_input);
        }
        if smoothed.is_empty() {
            return Ok(());
        }
        smoothed.reverse();
        (self.take)(first, smoothed)
    }

    /// Takes the filter over a part. `note` gets each step, the filter after it, and the mass of the
    /// model.
    fn filter(
        &mut self,
        part: Range<usize>,
        checkpoint: &mut Checkpoint<S>,
        mut note: impl FnMut(StepRecord<S>, &Filter<S>, ModelMass),
    ) -> Result<(), M::Error> {
        let Self {
            context,
            drifts,
            stuck_torques,
            steps,
            ..
        } = self;
        self.samples.each(part, |sample| {
            let sample = stuck_torques.without(sample, &mut checkpoint.torque_is_stuck);
            let sample = drifts.without(&sample, &mut checkpoint.has_drifted);
            let sample = steps.without(sample);
            if let Some(record) = checkpoint.filter.step(context, &sample) {
                checkpoint.cells += 1;
                if steps.contain(record.end.cell) {
                    checkpoint.filter.allow_step(&context.tuning);
                }
                let mass = ModelMass::of(context, &sample);
                note(record, &checkpoint.filter, mass);
            }
        })
    }
}
