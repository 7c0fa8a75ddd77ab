//! The match of a run: knot by knot, and cell by cell where it enters, leaves or changes roads.

use super::candidates::Candidates;
use super::knots::{Knot, cells_of, knots_of_run};
use super::viterbi::{self, MatchedPlace, match_knots};
use crate::files::run::RunCell;
use crate::map::geometry::network::Network;

/// Knots on each side of a change that are taken apart.
const BESIDE: usize = 2;
/// Times that knots beside changes are taken apart before all are.
const ROUNDS: usize = 4;

/// Knots of a run with their places on a network.
pub(crate) struct MatchedRun {
    /// In the order of driving.
    pub knots: Vec<Knot>,
    /// The place of each knot.
    pub places: Vec<MatchedPlace>,
}

/// Matches a run. Knots beside a change are taken apart into cells, so that the run is on the same
/// cells of a road as if each cell was matched.
pub(crate) fn match_run(network: &Network, cells: &[RunCell]) -> MatchedRun {
    let mut knots = knots_of_run(cells);
    let mut candidates = Candidates::of(network, &knots);
    for round in 0.. {
        let places = match_knots(network, &knots, &candidates);
        let apart = if round < ROUNDS {
            groups_at_changes(network, &knots, &places)
        } else {
            knots.iter().map(Knot::is_group).collect()
        };
        if !apart.contains(&true) {
            return MatchedRun { knots, places };
        }
        let (finer, before) = taken_apart(cells, &knots, &apart);
        candidates = candidates.refined(network, &finer, |i| before[i]);
        knots = finer;
    }
    unreachable!("all knots are cells after {ROUNDS} rounds")
}

/// Matches each cell of a run: what [`match_run`] is compared with.
pub(crate) fn match_every_cell(network: &Network, cells: &[RunCell]) -> MatchedRun {
    let knots: Vec<Knot> = cells_of(cells, 0..cells.len()).collect();
    let candidates = Candidates::of(network, &knots);
    let places = match_knots(network, &knots, &candidates);
    MatchedRun { knots, places }
}

/// Returns, for each knot, whether it has several cells and is beside a change.
fn groups_at_changes(network: &Network, knots: &[Knot], places: &[MatchedPlace]) -> Vec<bool> {
    let mut apart = vec![false; knots.len()];
    for i in 1..knots.len() {
        let driven_m = knots[i].odometer_m - knots[i - 1].odometer_m;
        if goes_on(network, places[i - 1], places[i], driven_m) {
            continue;
        }
        for near in i.saturating_sub(BESIDE)..knots.len().min(i + BESIDE) {
            apart[near] = knots[near].is_group();
        }
    }
    apart
}

/// Returns true if one place follows the other as the odometer says, on a road or beside it.
fn goes_on(network: &Network, from: MatchedPlace, to: MatchedPlace, driven_m: f64) -> bool {
    let (Some(a), Some(b)) = (from.on_road(), to.on_road()) else {
        return from == to;
    };
    let (price, joins) = viterbi::step(network, a, b, driven_m);
    price <= 1.0 || (price.is_finite() && !joins.is_empty())
}

/// Takes knots apart; returns the new knots, each with its index before if it is not new.
fn taken_apart(
    cells: &[RunCell],
    knots: &[Knot],
    apart: &[bool],
) -> (Vec<Knot>, Vec<Option<usize>>) {
    let mut finer = Vec::with_capacity(knots.len() + 64);
    let mut before = Vec::with_capacity(knots.len() + 64);
    for (i, knot) in knots.iter().enumerate() {
        if apart[i] {
            finer.extend(cells_of(cells, knot.cells.clone()));
            before.resize(finer.len(), None);
        } else {
            finer.push(knot.clone());
            before.push(Some(i));
        }
    }
    (finer, before)
}
