//! From matched points to smooth distances along the ways.

use super::knots::Knot;
use super::match_run::MatchedRun;
use super::viterbi;
use crate::files::run::RunCell;
use crate::map::geometry::network::Network;
use crate::numeric::local_fit;
use std::ops::Range;

/// Half width over which the offset between road and odometer is smoothed, m. Position noise of
/// 2-3 m is uneven over this; an odometer 1 % wrong shifts the offset by 1 m, evenly.
const OFFSET_REACH_M: f64 = 100.0;

/// Cells of a run that follow the network without a gap.
#[derive(Clone, Debug, PartialEq)]
pub struct MatchedSegment {
    /// Range of cells of the run.
    pub cells: Range<usize>,
    /// Distance of each cell along the legs, m; on the first leg that along its way.
    pub distance_m: Vec<f64>,
    /// The ways of the segment, in order.
    pub legs: Vec<Leg>,
}

/// A way, or a part of it, in a segment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Leg {
    /// Index of the way in the network.
    pub way: usize,
    /// Distance along the legs at its start, m.
    pub begins_m: f64,
    /// Distance along the legs minus that along the way, m.
    pub offset_m: f64,
}

/// A segment under construction.
#[derive(Debug)]
struct Open {
    /// The last place on a way, and the odometer there.
    last: (usize, f64, f64),
    /// Matched knots with their raw distance along the legs.
    on: Vec<(usize, f64)>,
    legs: Vec<Leg>,
}

/// Returns the matched segments of a run. Cells without a position belong to a segment if it
/// continues after them (matching has compared it with the odometer).
pub(crate) fn matched_segments(
    network: &Network,
    cells: &[RunCell],
    run: &MatchedRun,
) -> Vec<MatchedSegment> {
    let mut found = Vec::new();
    let mut open: Option<Open> = None;
    for (i, (knot, place)) in run.knots.iter().zip(&run.places).enumerate() {
        let Some((way, distance_m)) = place.on_road() else {
            found.extend(open.take());
            continue;
        };
        let here = (way, distance_m, knot.odometer_m);
        let goes_on = open
            .as_mut()
            .is_some_and(|open| open.take(network, i, here));
        if !goes_on {
            found.extend(open.replace(Open::at(i, here)));
        }
    }
    found.extend(open);
    found
        .into_iter()
        .map(|open| smoothed(cells, &run.knots, &open.on, open.legs))
        .collect()
}

impl Open {
    fn at(i: usize, here: (usize, f64, f64)) -> Self {
        let leg = Leg {
            way: here.0,
            begins_m: f64::NEG_INFINITY,
            offset_m: 0.0,
        };
        Self {
            last: here,
            on: vec![(i, here.1)],
            legs: vec![leg],
        }
    }

    /// Continues to a place, with the legs between. Returns `false` if no route leads there.
    fn take(&mut self, network: &Network, i: usize, here: (usize, f64, f64)) -> bool {
        let (way, from_m, odometer_m) = self.last;
        let driven_m = here.2 - odometer_m;
        let (price, joins) = viterbi::step(network, (way, from_m), (here.0, here.1), driven_m);
        for join in joins {
            let leg = self.legs[self.legs.len() - 1];
            let begins_m = leg.offset_m + join.at_m;
            self.legs.push(Leg {
                way: join.to_way,
                begins_m: begins_m.max(leg.begins_m),
                offset_m: begins_m - join.to_m,
            });
        }
        if !price.is_finite() {
            return false;
        }
        let leg = self.legs[self.legs.len() - 1];
        self.on.push((i, here.1 + leg.offset_m));
        self.last = here;
        true
    }
}

/// Returns the segment through the matched knots `on`, with their raw distances along the legs.
fn smoothed(
    cells: &[RunCell],
    knots: &[Knot],
    on: &[(usize, f64)],
    legs: Vec<Leg>,
) -> MatchedSegment {
    let of_knots = || on.iter().map(|&(i, _)| &knots[i]);
    let odometer_m: Vec<f64> = of_knots().map(|knot| knot.odometer_m).collect();
    let weight: Vec<f64> = of_knots().map(Knot::weight).collect();
    let offset_m: Vec<f64> = on
        .iter()
        .zip(&odometer_m)
        .map(|(&(_, distance_m), odometer_m)| distance_m - odometer_m)
        .collect();
    let offset_m = local_fit::smooth_weighted::<2>(&odometer_m, &offset_m, &weight, OFFSET_REACH_M);
    let (first, last) = (&knots[on[0].0], &knots[on[on.len() - 1].0]);
    let range = first.cells.start..last.cells.end;
    let mut after = 0;
    // Between knots, and without positions, the offset is interpolated.
    let mut slope = 0.0;
    let distance_m = cells[range.clone()]
        .iter()
        .map(|cell| {
            let here_m = cell.distance_m;
            while after + 1 < odometer_m.len() && odometer_m[after] < here_m {
                after += 1;
                let apart_m = odometer_m[after] - odometer_m[after - 1];
                slope = (offset_m[after] - offset_m[after - 1]) / apart_m.max(f64::MIN_POSITIVE);
            }
            if after == 0 || odometer_m[after] <= here_m {
                return here_m + offset_m[after];
            }
            here_m + offset_m[after - 1] + slope * (here_m - odometer_m[after - 1])
        })
        .collect();
    MatchedSegment {
        cells: range,
        distance_m,
        legs,
    }
}
