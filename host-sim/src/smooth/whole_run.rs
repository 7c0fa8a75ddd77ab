//! Smoothing of a whole run with inferred variances, piece by piece.
//!
//! A piece is long beside all that the filter remembers, and overlaps its neighbours by some
//! kilometres. Memory therefore does not grow with the run.

use super::disagreements::Disagreements;
use super::piece::{MeasurementSink, Piece};
use super::samples::Samples;
use super::smoothed_cell::SmoothedCell;
use estimator_core::filter::{SlowStates, VehicleCells};
use estimator_core::{Context, Delay, Sample};

/// Cells of a piece, 100 km.
const PIECE: usize = 40_000;
/// Cells by which it goes beyond its ends, 10 km.
const OVERLAP: usize = 4_000;

/// What is known before a run, from an earlier one.
#[derive(Clone, Copy, Debug, Default)]
pub struct Known<'a> {
    /// The states of the vehicle.
    pub slow_states: Option<&'a SlowStates>,
    /// Whether brakes act that no signal reports.
    pub hides_brakes: bool,
    /// The receiver's low-pass on altitudes; without one, the run shows it as it goes on.
    pub altitude_delay: Option<Delay>,
}

/// Smooths a run. Returns one cell for each sample from the first speed on.
#[must_use]
pub fn smooth_run(context: &Context, known: Known<'_>, samples: &[Sample]) -> Vec<SmoothedCell> {
    let mut cells = Vec::new();
    let Ok(_) = smooth_pieces(context, known, &mut { samples }, None, |_, piece| {
        cells.extend(piece);
        Ok(())
    });
    cells
}

/// Smooths a run that need not fit into memory. `take` gets the cells from the first speed on, piece by
/// piece in the order of the run, with the index of the first one; `measured`, if there is one, gets
/// their measurements. Returns where signals disagree.
///
/// # Errors
/// Returns the error of `samples`, of `measured` or of `take`.
pub fn smooth_pieces<M: Samples>(
    context: &Context,
    known: Known<'_>,
    samples: &mut M,
    mut measured: Option<&mut MeasurementSink<'_, M::Error>>,
    mut take: impl FnMut(usize, Vec<SmoothedCell>) -> Result<(), M::Error>,
) -> Result<Disagreements, M::Error> {
    let numbers = &context.tuning.estimation;
    let mut disagreements = Disagreements::default();
    let all = samples.count();
    let mut maker = known
        .altitude_delay
        .map_or_else(VehicleCells::default, VehicleCells::with_low_pass);
    let (mut done, mut given) = (0, 0);
    while done < all {
        let end = (done + PIECE).min(all);
        let range = done.saturating_sub(OVERLAP)..(end + OVERLAP).min(all);
        let mut piece = Piece::default();
        let next_start = end.saturating_sub(OVERLAP);
        let mut at = range.start;
        let mut next_maker = None;
        samples.each(range, |sample| {
            if at == next_start {
                next_maker = Some(maker.clone());
            }
            let is_own = (done..end).contains(&at);
            piece.push(context, known.slow_states, &mut maker, sample, is_own);
            at += 1;
        })?;
        let mut cells = Vec::new();
        if let Some(mut inferred) = piece.infer(numbers, known.hides_brakes) {
            let origin_m = maker.origin_m();
            cells = piece.smooth(numbers, &mut inferred, origin_m);
            if let Some(measured) = &mut measured {
                piece.measurements(&mut inferred, origin_m, measured)?;
            }
        }
        if let Some(next) = next_maker {
            maker = next;
        }
        let count = cells.len();
        for (cell, disagreement) in &cells {
            disagreements.add(*disagreement, cell.end.cell);
        }
        take(given, cells.into_iter().map(|(cell, _)| cell).collect())?;
        given += count;
        done = end;
    }
    Ok(disagreements)
}
