//! Cells of a run beside the truth.

use super::drives::Plan;
use super::truth::Driven;
use host_sim::files::run::RunRow;
use host_sim::simulator::geodesy::Position;
use host_sim::simulator::road::Road;

/// Ways at both ends of a drive that are not judged, m.
const ENDS_M: f64 = 500.0;
/// Way after the onset of a fault on which the live estimate is not judged, m.
const ONSET_M: f64 = 500.0;
/// Way around the true place in which a stated position is looked for, m, and its step, m.
const SEARCH: (f64, f64) = (250.0, 5.0);

/// The kind of an estimate.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// Over the whole run.
    Smoothed,
    /// After a fixed lag.
    Lagged,
    /// Causal.
    Live,
}

impl Kind {
    /// The three kinds, in the order of the table.
    pub const ALL: [Self; 3] = [Self::Smoothed, Self::Lagged, Self::Live];

    /// Returns grade and sigma, %.
    const fn of(self, row: &RunRow) -> (f64, f64) {
        match self {
            Self::Smoothed => row.smoothed(),
            Self::Lagged => row.lagged(),
            Self::Live => row.live(),
        }
    }
}

/// Returns true if a row is marked as suspect.
#[must_use]
pub const fn is_marked(row: &RunRow, kind: Kind) -> bool {
    let consistent = match kind {
        Kind::Smoothed => row.consistent,
        Kind::Lagged => row.lagged_consistent,
        Kind::Live => row.live_consistent,
    };
    consistent == 0
}

/// One estimate of one cell.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Judged {
    /// Estimate minus truth, %.
    pub error_percent: f64,
    /// Stated standard deviation, %.
    pub sigma_percent: f64,
    /// True if it is marked as suspect.
    pub is_marked: bool,
}

/// One cell beside the truth: smoothed, lagged and live.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct JudgedCell {
    /// True distance driven forwards, m.
    pub driven_m: f64,
    /// The estimates.
    pub of: [Judged; 3],
    /// True on the first 500 m after the onset of a fault.
    pub is_onset: bool,
    /// Way since the end of the last fault, m; `None` before and during a fault.
    pub after_m: Option<f64>,
}

impl JudgedCell {
    /// Returns the cell as if none of its estimates were marked.
    #[must_use]
    pub fn without_marks(&self) -> Self {
        let of = self.of.map(|judged| Judged {
            is_marked: false,
            ..judged
        });
        Self { of, ..*self }
    }
}

/// The cells of a run, and those that should not be.
#[derive(Clone, Debug, Default)]
pub struct RunCells {
    /// Cells that are judged.
    pub cells: Vec<JudgedCell>,
    /// Cells made while the vehicle reversed.
    pub in_reverse: usize,
}

/// Compares a run with the truth at the same times.
#[must_use]
pub fn compare(plan: &Plan, driven: &Driven, rows: &[RunRow]) -> RunCells {
    let end_m = driven.moments.last().map_or(0.0, |moment| moment.driven_m);
    let faults = extents(plan, driven);
    let mut cells = RunCells::default();
    for row in rows {
        let Some(moment) = driven.at(row.time_s) else {
            continue;
        };
        if moment.reverses {
            cells.in_reverse += 1;
            continue;
        }
        if !(ENDS_M..end_m - ENDS_M).contains(&moment.driven_m) {
            continue;
        }
        let grade_percent = match (plan.by_place, row.latitude_deg, row.longitude_deg) {
            (true, Some(latitude_deg), Some(longitude_deg)) => {
                let stated = Position {
                    latitude_deg,
                    longitude_deg,
                };
                let place_m = nearest_m(&driven.road, stated, moment.place_m + driven.start_m);
                100.0 * driven.road.grade(place_m)
            }
            (true, ..) => continue,
            (false, ..) => moment.grade_percent,
        };
        cells.cells.push(JudgedCell {
            driven_m: moment.driven_m,
            of: Kind::ALL.map(|kind| {
                let (value, sigma_percent) = kind.of(row);
                Judged {
                    error_percent: value - grade_percent,
                    sigma_percent,
                    is_marked: is_marked(row, kind),
                }
            }),
            is_onset: faults
                .iter()
                .any(|fault| (fault.0..fault.0 + ONSET_M).contains(&moment.driven_m)),
            after_m: after_m(&faults, moment.driven_m),
        });
    }
    cells
}

/// Returns the faults from and to, as distances driven forwards, m.
fn extents(plan: &Plan, driven: &Driven) -> Vec<(f64, f64)> {
    let driven_m = |time_s| {
        driven
            .at(time_s)
            .map_or(f64::INFINITY, |moment| moment.driven_m)
    };
    plan.faults
        .iter()
        .map(|when| {
            let times = driven.times_s(*when);
            (driven_m(times.start), driven_m(times.end))
        })
        .collect()
}

/// Returns the way since the last fault ended, m; `None` before and during faults.
fn after_m(faults: &[(f64, f64)], driven_m: f64) -> Option<f64> {
    if faults
        .iter()
        .any(|fault| (fault.0..fault.1).contains(&driven_m))
    {
        return None;
    }
    faults
        .iter()
        .filter(|fault| fault.1 <= driven_m)
        .map(|fault| driven_m - fault.1)
        .reduce(f64::min)
}

/// Returns the place on the road that is nearest to a position, m, near `about_m`.
fn nearest_m(road: &Road, stated: Position, about_m: f64) -> f64 {
    let (reach_m, step_m) = SEARCH;
    let east = stated.latitude_deg.to_radians().cos();
    let square = |place_m: f64| {
        let there = road.position(place_m);
        let north = there.latitude_deg - stated.latitude_deg;
        north.powi(2) + (east * (there.longitude_deg - stated.longitude_deg)).powi(2)
    };
    let count = (2.0 * reach_m / step_m) as usize;
    (0..=count)
        .map(|index| about_m - reach_m + step_m * index as f64)
        .min_by(|a, b| square(*a).total_cmp(&square(*b)))
        .unwrap_or(about_m)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_way_after_a_fault_counts_from_the_last_end() {
        let faults = [(1_000.0, 2_000.0), (5_000.0, 5_000.0)];
        assert_eq!(after_m(&faults, 500.0), None);
        assert_eq!(after_m(&faults, 1_500.0), None);
        assert_eq!(after_m(&faults, 2_500.0), Some(500.0));
        assert_eq!(after_m(&faults, 6_000.0), Some(1_000.0));
    }
}
