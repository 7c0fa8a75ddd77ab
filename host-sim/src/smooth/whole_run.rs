//! Smoothing of a whole run.
//!
//! The samples pass the core's filter a second time, in double precision and with the final
//! estimate of the sensor noise from the first pass. The core's backward pass then runs over the
//! whole run.
//!
//! The records of all cells are not kept in memory. The run is divided into parts, and the filter
//! state before each part is stored. On the backward pass each part is filtered again from there. A
//! part that is still too long is divided again (A. Griewank, "Achieving logarithmic growth of
//! temporal and spatial complexity in reverse automatic differentiation", Optimization Methods and
//! Software 1:35, 1992). The filter therefore runs three times over up to 41 km, and once more for
//! each factor of 32. Memory, [`held_bytes`], grows by the same steps. The results equal those of a
//! smoother that keeps everything, bit for bit.

use super::disagreements::Disagreements;
use super::drifts::Drifts;
use super::filtered_cell::ForwardCell;
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
        samples,
        drifts: Drifts::default(),
        stuck_torques: StuckTorques::default(),
        disagreements: Disagreements::default(),
        pass: BackwardPass::new(),
        take,
    };
    let start = Checkpoint {
        filter: filter.clone(),
        has_drifted: false,
        torque_is_stuck: false,
        cells: 0,
    };
    let mut first = smoother.look(start.clone())?;
    if !first.stuck_torques.is_empty() {
        smoother.stuck_torques = core::mem::take(&mut first.stuck_torques);
        first = smoother.look(start.clone())?;
    }
    let FirstLook {
        negative_log_likelihood: mut least,
        drifts,
        disagreements,
        ..
    } = first;
    smoother.disagreements = disagreements;
    if !drifts.is_empty() {
        let mut believing = tuning.clone();
        believing.gates.drift_sigmas = f32::INFINITY;
        let mut best = (Drifts::default(), tuning.clone());
        for other in [(drifts, tuning.clone()), (Drifts::default(), believing)] {
            (smoother.drifts, smoother.context.tuning) = other.clone();
            let found = smoother.look(start.clone())?;
            if found.negative_log_likelihood < least {
                (least, best) = (found.negative_log_likelihood, other);
                smoother.disagreements = found.disagreements;
            }
        }
        (smoother.drifts, smoother.context.tuning) = best;
    }
    let all = 0..smoother.samples.count();
    smoother.go_back(all, start)?;
    Ok(smoother.disagreements)
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

/// What a pass over the run finds before it is smoothed.
struct FirstLook {
    /// Mean over the altitudes, times two and but for a constant.
    negative_log_likelihood: f64,
    drifts: Drifts,
    stuck_torques: StuckTorques,
    disagreements: Disagreements,
}

struct Smoother<'a, S, M, T> {
    context: Context,
    samples: &'a mut M,
    /// Drifts whose altitudes are not used.
    drifts: Drifts,
    /// Torques that are not used.
    stuck_torques: StuckTorques,
    /// Where signals disagree.
    disagreements: Disagreements,
    /// The estimate from the later cells.
    pass: BackwardPass<S>,
    take: T,
}

impl<S, M, T> Smoother<'_, S, M, T>
where
    S: Scalar,
    M: Samples,
    T: FnMut(usize, Vec<SmoothedCell>) -> Result<(), M::Error>,
{
    /// Takes the filter over the run, and returns how likely its altitudes are and what it found.
    fn look(&mut self, mut from: Checkpoint<S>) -> Result<FirstLook, M::Error> {
        let (mut sum, mut altitudes) = (-0.0, 0_usize);
        let mut drifts = Drifts::default();
        let mut stuck_torques = StuckTorques::default();
        let mut disagreements = Disagreements::default();
        let all = 0..self.samples.count();
        self.filter(all, &mut from, |record, _, _| {
            if let Some(update) = record.smoother_input.altitude() {
                let variance = update.innovation_variance.to_f64();
                sum += update.innovation.to_f64().powi(2) / variance + variance.ln();
                altitudes += 1;
            }
            drifts.note(record.event, record.end.cell);
            stuck_torques.note(record.event, record.end.cell);
            disagreements.note(&record);
        })?;
        Ok(FirstLook {
            negative_log_likelihood: sum / altitudes as f64,
            drifts,
            stuck_torques,
            disagreements,
        })
    }

    /// Goes back over a part, before which the filter was at `start`.
    fn go_back(&mut self, part: Range<usize>, start: Checkpoint<S>) -> Result<(), M::Error> {
        if part.len() <= RECORDS {
            return self.go_back_over_records(part, start);
        }
        let length = part.len().div_ceil(PARTS);
        let mut marks = Vec::with_capacity(PARTS);
        let mut checkpoint = start;
        for begin in part.clone().step_by(length) {
            let within = begin..part.end.min(begin + length);
            marks.push((within.clone(), checkpoint.clone()));
            if within.end < part.end {
                self.filter(within, &mut checkpoint, |_, _, _| ())?;
            }
        }
        while let Some((within, checkpoint)) = marks.pop() {
            self.go_back(within, checkpoint)?;
        }
        Ok(())
    }

    fn go_back_over_records(
        &mut self,
        part: Range<usize>,
        mut start: Checkpoint<S>,
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
        let mut smoothed: Vec<SmoothedCell> = Vec::with_capacity(filtered.len());
        for ForwardCell {
            record,
            state,
            mass,
        } in filtered.iter().rev()
        {
            smoothed.push(SmoothedCell {
                end: record.end,
                estimate: self.pass.estimate(state, mass),
                is_consistent: !self.disagreements.cover(record.end.cell),
            });
            self.pass.retreat(&record.smoother_input);
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
            ..
        } = self;
        self.samples.each(part, |sample| {
            let sample = stuck_torques.without(sample, &mut checkpoint.torque_is_stuck);
            let sample = drifts.without(&sample, &mut checkpoint.has_drifted);
            if let Some(record) = checkpoint.filter.step(context, &sample) {
                checkpoint.cells += 1;
                let mass = ModelMass::of(context, &sample);
                note(record, &checkpoint.filter, mass);
            }
        })
    }
}
