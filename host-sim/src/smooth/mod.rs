//! Smoothing of a whole run.
//!
//! The samples that the core saw go through its filter a second time, in double precision and with
//! the sensor noise that was known only at the end of the first; then the recursion of the core's
//! fixed lag goes back over all of it.
//!
//! What the filter left at each cell is not kept: the run is cut into parts, the filter as it was
//! before each part is, and on the way back a part is gone over again from there; a part that is
//! still too long is cut again (A. Griewank, "Achieving logarithmic growth of temporal and spatial
//! complexity in reverse automatic differentiation", Optimization Methods and Software 1:35, 1992).
//! So the filter goes over the run three times up to 41 km and once more for each factor of 32, and
//! what is held, [`held_bytes`], grows by the same steps and no further. The numbers are those of
//! a smoother that keeps everything, to the last bit.

mod drifts;
mod samples;

pub use samples::Samples;

use drifts::Drifts;
use estimator_core::filter::{Backward, Filter, Moved, Record};
use estimator_core::sampler::Sample;
use estimator_core::{Counters, Estimate, Place, Scalar, Tuning, VehicleParameters};
use std::ops::Range;

/// Cells of a part whose records are held.
const RECORDS: usize = 512;
/// Parts that a longer one is cut into.
const PARTS: usize = 32;

/// A cell of a smoothed run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Smoothed {
    /// Where and when.
    pub place: Place,
    /// What is known there with all of the run.
    pub estimate: Estimate,
}

/// The smoothed run: one cell for each sample from the first speed on. `filter` is the one that the
/// run begins with: that of the first pass [anew](Filter::anew).
///
/// Where the filter finds that GNSS drifts, it has already followed it for some hundred metres: it
/// then goes over the run twice more, without the fixes since the drift began, and believing all of
/// them: a vehicle far from its parameters looks the same from where it begins. The pass counts that
/// its fixes fit best.
#[must_use]
pub fn smooth_run<S: Scalar>(
    vehicle: &VehicleParameters,
    tuning: &Tuning,
    filter: &Filter<S>,
    samples: &[Sample],
) -> Vec<Smoothed> {
    let mut stretches = Vec::new();
    let Ok(()) = smooth_stretches(vehicle, tuning, filter, &mut { samples }, |_, stretch| {
        stretches.push(stretch);
        Ok(())
    });
    stretches.into_iter().rev().flatten().collect()
}

/// The same for a run that need not be in memory, from its end to its start: `take` gets one
/// stretch after the other, each in the order of the run, with the number of its first cell.
///
/// # Errors
/// Those of `samples` and of `take`.
pub fn smooth_stretches<S: Scalar, M: Samples>(
    vehicle: &VehicleParameters,
    tuning: &Tuning,
    filter: &Filter<S>,
    samples: &mut M,
    take: impl FnMut(usize, Vec<Smoothed>) -> Result<(), M::Error>,
) -> Result<(), M::Error> {
    let mut smoother = Smoother {
        vehicle,
        tuning: tuning.clone(),
        samples,
        drifts: Drifts::default(),
        backward: Backward::new(),
        take,
    };
    let start = Walk {
        filter: filter.clone(),
        has_drifted: false,
        cells: 0,
    };
    let (mut least, drifts) = smoother.judge(start.clone())?;
    if !drifts.is_empty() {
        let believing = Tuning {
            drift_sigmas: f32::INFINITY,
            ..tuning.clone()
        };
        let mut best = (Drifts::default(), tuning.clone());
        for other in [(drifts, tuning.clone()), (Drifts::default(), believing)] {
            (smoother.drifts, smoother.tuning) = other.clone();
            let (negative_log_likelihood, _) = smoother.judge(start.clone())?;
            if negative_log_likelihood < least {
                (least, best) = (negative_log_likelihood, other);
            }
        }
        (smoother.drifts, smoother.tuning) = best;
    }
    let all = 0..smoother.samples.count();
    smoother.go_back(all, start)
}

/// Memory that smoothing of so many cells takes, bytes: no more for a longer run, but for one more
/// level of parts at 41, 1,300 and 42,000 km.
#[must_use]
pub const fn held_bytes(cells: usize) -> usize {
    let mut levels = 0;
    let mut part = cells;
    while part > RECORDS {
        part = part.div_ceil(PARTS);
        levels += 1;
    }
    let mark = size_of::<(Range<usize>, Walk<f64>)>();
    RECORDS * (size_of::<Record<f64>>() + size_of::<Smoothed>()) + levels * PARTS * mark
}

/// The filter on its way over the run.
#[derive(Clone)]
struct Walk<S> {
    filter: Filter<S>,
    /// Whether the last altitudes were left out because they drifted.
    has_drifted: bool,
    /// Cells gone over since the first speed.
    cells: usize,
}

struct Smoother<'a, S, M, T> {
    vehicle: &'a VehicleParameters,
    tuning: Tuning,
    samples: &'a mut M,
    /// Those whose altitudes are left out.
    drifts: Drifts,
    /// What the cells already gone back over say.
    backward: Backward<S>,
    take: T,
}

impl<S, M, T> Smoother<'_, S, M, T>
where
    S: Scalar,
    M: Samples,
    T: FnMut(usize, Vec<Smoothed>) -> Result<(), M::Error>,
{
    /// Mean of minus twice the logarithm of the likelihood of an altitude, but for a constant; and
    /// the drifts that the filter found.
    fn judge(&mut self, mut walk: Walk<S>) -> Result<(f64, Drifts), M::Error> {
        let (mut sum, mut altitudes) = (-0.0, 0_usize);
        let mut found = Drifts::default();
        let all = 0..self.samples.count();
        self.walk(all, &mut walk, |moved, _| {
            if let Some(used) = moved.trace.altitude {
                let variance = used.innovation_variance.to_f64();
                sum += used.innovation.to_f64().powi(2) / variance + variance.ln();
                altitudes += 1;
            }
            found.note(moved.event, moved.place.cell);
        })?;
        Ok((sum / altitudes as f64, found))
    }

    /// Goes back over a part, before which the filter was at `start`.
    fn go_back(&mut self, part: Range<usize>, start: Walk<S>) -> Result<(), M::Error> {
        if part.len() <= RECORDS {
            return self.go_back_over_records(part, start);
        }
        let length = part.len().div_ceil(PARTS);
        let mut marks = Vec::with_capacity(PARTS);
        let mut walk = start;
        for begin in part.clone().step_by(length) {
            let within = begin..part.end.min(begin + length);
            marks.push((within.clone(), walk.clone()));
            if within.end < part.end {
                self.walk(within, &mut walk, |_, _| ())?;
            }
        }
        while let Some((within, walk)) = marks.pop() {
            self.go_back(within, walk)?;
        }
        Ok(())
    }

    fn go_back_over_records(
        &mut self,
        part: Range<usize>,
        mut walk: Walk<S>,
    ) -> Result<(), M::Error> {
        let first = walk.cells;
        let mut records = Vec::with_capacity(part.len());
        self.walk(part, &mut walk, |moved, filter| {
            records.extend(filter.state().map(|state| Record {
                place: moved.place,
                trace: moved.trace,
                state: *state,
                event: moved.event,
            }));
        })?;
        let mut smoothed: Vec<Smoothed> = Vec::with_capacity(records.len());
        for record in records.iter().rev() {
            smoothed.push(Smoothed {
                place: record.place,
                estimate: self.backward.estimate(&record.state),
            });
            self.backward.retreat(&record.trace);
        }
        smoothed.reverse();
        (self.take)(first, smoothed)
    }

    /// Takes the filter over a part; `note` sees each step and where the filter is then.
    fn walk(
        &mut self,
        part: Range<usize>,
        walk: &mut Walk<S>,
        mut note: impl FnMut(Moved<S>, &Filter<S>),
    ) -> Result<(), M::Error> {
        let mut counters = Counters::default();
        let Self {
            vehicle,
            tuning,
            drifts,
            ..
        } = self;
        self.samples.each(part, |sample| {
            let sample = drifts.without(sample, &mut walk.has_drifted);
            let moved = walk.filter.advance(vehicle, tuning, &sample, &mut counters);
            if let Some(moved) = moved {
                walk.cells += 1;
                note(moved, &walk.filter);
            }
        })
    }
}
