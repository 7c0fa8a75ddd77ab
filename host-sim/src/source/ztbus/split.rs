//! One-way trips: a mission is split where the bus waits at its termini.
//!
//! No timetable and no map is used. The termini are where the drive turns back on its own road. The
//! first trip starts, and the last one ends, at a terminus of the trips between them. The rest is
//! the drive from and to the garage.

use super::mission::{Mission, MissionRow};
use super::turning::{PlanePoint, Turn, turns};
use map_3d::{Ellipsoid, geodetic2enu};
use std::ops::Range;

/// Largest speed at standstill, m/s.
const STANDSTILL_MPS: f64 = 0.1;
/// Largest distance of a waiting bus from the road that it drives both ways, m.
const WAITING_M: f64 = 150.0;
/// Largest distance of places of one terminus, m.
const TERMINUS_M: f64 = 300.0;
/// Largest distance of a bus at a terminus, m.
const VISIT_M: f64 = 200.0;
/// Longest loop in which the bus turns, m.
const TURNING_LOOP_M: f64 = 1_000.0;
/// Trips that cover less than this fraction of the drive do not define its structure.
const COVERED_PART: f64 = 0.3;

/// Direction of a pass.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "lowercase")]
pub enum PassDirection {
    /// In the direction of the first pass between its two termini.
    Outbound,
    /// In the opposite direction.
    Inbound,
}

impl PassDirection {
    /// Returns the word for tables and file names.
    #[must_use]
    pub const fn word(self) -> &'static str {
        match self {
            Self::Outbound => "outbound",
            Self::Inbound => "inbound",
        }
    }
}

/// A one-way trip from terminus to terminus.
#[derive(Clone, Debug, PartialEq)]
pub struct Pass {
    /// Direction.
    pub direction: PassDirection,
    /// Its rows, from the last one at standstill in one terminus to the first one in the next.
    pub rows: Range<usize>,
    /// Start since the mission's first row, s.
    pub start_s: f64,
    /// Duration, s.
    pub duration_s: f64,
    /// Driven distance, m.
    pub length_m: f64,
    /// GNSS altitude at its end less that at its start, m. Each is the mean while the bus stood
    /// there.
    pub climb_m: Option<f64>,
    /// Mean number of passengers over the rows with a count.
    pub passengers_mean: Option<f64>,
    from: Halt,
    to: Halt,
}

impl Pass {
    /// Returns true if `next` follows immediately and goes back to the start of this pass.
    fn returns_with(&self, next: &Self) -> bool {
        self.to.rows == next.from.rows
            && self.from.terminus == next.to.terminus
            && self.from.terminus != self.to.terminus
    }
}

/// The rows of a wait at a terminus; one row where the bus did not stop.
#[derive(Clone, Debug, PartialEq)]
struct Halt {
    rows: Range<usize>,
    terminus: usize,
}

impl Mission {
    /// Returns the one-way trips between termini, in order of time; see [`Pass`].
    #[must_use]
    pub fn passes(&self) -> Vec<Pass> {
        passes(self)
    }
}

/// Returns the row ranges of the complete round trips. Each is a pass and the next pass back to its
/// start; no pass is in two of them.
///
/// A round trip ends where it began. Any altitude that a model gains on it is an error.
#[must_use]
pub fn round_trips(passes: &[Pass]) -> Vec<Range<usize>> {
    let mut trips = Vec::new();
    let mut rest = passes;
    while let [first, tail @ ..] = rest {
        rest = tail;
        if let [second, after @ ..] = tail
            && first.returns_with(second)
        {
            trips.push(first.rows.start..second.rows.end);
            rest = after;
        }
    }
    trips
}

/// Returns the passes of a mission; the whole drive from the first fix if it never turns back.
fn passes(mission: &Mission) -> Vec<Pass> {
    let drive = MissionTrack::new(mission);
    let trips = drive.trips();
    let covered_m: f64 = trips
        .iter()
        .map(|(from, to)| drive.driven_m(to.rows.start) - drive.driven_m(from.rows.end - 1))
        .sum();
    let whole_m = drive.driven_m(mission.rows.len() - 1) - drive.driven_m(mission.first_fix);
    let trips = if covered_m < COVERED_PART * whole_m || trips.is_empty() {
        vec![drive.whole()]
    } else {
        trips
    };
    let mut passes: Vec<Pass> = Vec::new();
    for (from, to) in trips {
        let seen_other_way = passes.iter().any(|pass| {
            pass.direction == PassDirection::Outbound
                && (pass.from.terminus, pass.to.terminus) == (to.terminus, from.terminus)
        });
        let direction = if seen_other_way {
            PassDirection::Inbound
        } else {
            PassDirection::Outbound
        };
        passes.push(drive.pass(direction, from, to));
    }
    passes
}

/// A mission as a track on a plane.
struct MissionTrack<'a> {
    mission: &'a Mission,
    /// East and north of the first fix, m; one entry per row.
    plane_m: Vec<Option<(f64, f64)>>,
}

impl<'a> MissionTrack<'a> {
    fn new(mission: &'a Mission) -> Self {
        let origin = mission.rows[mission.first_fix].position_deg();
        let on_plane = |row: &MissionRow| {
            let ((lat, lon), (lat0, lon0)) = row.position_deg().zip(origin)?;
            let (east_m, north_m, _) = geodetic2enu(
                lat.to_radians(),
                lon.to_radians(),
                0.0,
                lat0.to_radians(),
                lon0.to_radians(),
                0.0,
                Ellipsoid::WGS84,
            );
            Some((east_m, north_m))
        };
        Self {
            mission,
            plane_m: mission.rows.iter().map(on_plane).collect(),
        }
    }

    fn driven_m(&self, row: usize) -> f64 {
        self.mission.odometer_m[row]
    }

    /// Returns the first row at or beyond this driven distance.
    fn row_at(&self, driven_m: f64) -> usize {
        let row = self.mission.odometer_m.partition_point(|&m| m < driven_m);
        row.min(self.mission.rows.len() - 1)
    }

    fn turns(&self) -> Vec<Turn> {
        let places: Vec<PlanePoint> = self
            .plane_m
            .iter()
            .zip(&self.mission.odometer_m)
            .filter_map(|(plane, &driven_m)| {
                plane.map(|(east_m, north_m)| PlanePoint {
                    driven_m,
                    east_m,
                    north_m,
                })
            })
            .collect();
        turns(&places)
    }

    /// Returns the start and the end of each trip.
    fn trips(&self) -> Vec<(Halt, Halt)> {
        let turns = self.turns();
        let mut termini = Termini::default();
        let mut trips = Vec::new();
        let mut done = self.mission.first_fix;
        let mut left = turns.as_slice();
        // After a change of route, the bus drives a road that it never retraces.
        for chain in turns.chunk_by(Turn::shares_road_with) {
            left = &left[chain.len()..];
            let end = left.first().map_or(self.mission.rows.len(), |next| {
                self.row_at(next.before_m.1 - WAITING_M)
            });
            let halts = self.halts(chain, &mut termini, done..end);
            done = halts.last().map_or(done, |halt| halt.rows.end);
            trips.extend(
                halts
                    .windows(2)
                    .map(|two| (two[0].clone(), two[1].clone()))
                    .filter(|(from, to)| {
                        from.terminus != to.terminus && from.rows.end <= to.rows.start
                    }),
            );
        }
        trips
    }

    /// Returns the halts of trips on one road, within `bounds`.
    fn halts(&self, turns: &[Turn], termini: &mut Termini, bounds: Range<usize>) -> Vec<Halt> {
        let mut near = |from_m: f64, driven_m: f64, to_m: f64| {
            let rows = self.row_at(from_m - WAITING_M)..self.row_at(to_m + WAITING_M) + 1;
            self.halt(termini, rows, self.row_at(driven_m))
        };
        let mut halts: Vec<Halt> = turns
            .iter()
            .map(|turn| near(turn.before_m.1, turn.driven_m, turn.after_m.0))
            .collect();
        let (start, end) = if let ([first, second, ..], [.., before_last, last]) =
            (halts.as_slice(), halts.as_slice())
        {
            (
                self.halt_before(first, termini, second.terminus, bounds.start),
                self.halt_after(last, termini, before_last.terminus, bounds.end),
            )
        } else {
            // Only one terminus is known. The trips extend as far as the road is the same.
            let mut at = |driven_m: f64| near(driven_m, driven_m, driven_m);
            let reach_m = turns.first().map(|turn| (turn.before_m.0, turn.after_m.1));
            (
                reach_m.map(|(start_m, _)| at(start_m)),
                reach_m.map(|(_, end_m)| at(end_m)),
            )
        };
        halts.extend(end);
        halts.splice(..0, start);
        halts
    }

    /// Returns the longest wait in `rows`, else the row `otherwise`.
    fn halt(&self, termini: &mut Termini, rows: Range<usize>, otherwise: usize) -> Halt {
        let rows = self
            .longest_wait(rows, |_| true)
            .unwrap_or(otherwise..otherwise + 1);
        let place = self.plane_m[..rows.end]
            .iter()
            .rev()
            .find_map(|place| *place)
            .unwrap_or_default();
        Halt {
            rows,
            terminus: termini.index(place),
        }
    }

    /// Returns the longest run of rows at standstill where `counts` holds.
    fn longest_wait(
        &self,
        rows: Range<usize>,
        counts: impl Fn(usize) -> bool,
    ) -> Option<Range<usize>> {
        let mut longest: Option<Range<usize>> = None;
        let mut start = rows.start;
        for row in rows {
            let speed_mps = self.mission.rows[row].speed_mps;
            if !(speed_mps.is_some_and(|mps| mps < STANDSTILL_MPS) && counts(row)) {
                start = row + 1;
            } else if longest.as_ref().is_none_or(|l| row + 1 - start > l.len()) {
                longest = Some(start..row + 1);
            }
        }
        longest
    }

    /// Returns the last halt at a known terminus before another halt, not before row `start`;
    /// `None` if the bus was not there.
    fn halt_before(
        &self,
        halt: &Halt,
        termini: &Termini,
        terminus: usize,
        start: usize,
    ) -> Option<Halt> {
        let place = termini.place(terminus);
        let last = (start..halt.rows.start)
            .rev()
            .find(|&row| self.offset_m(row, place) < VISIT_M)?;
        let first = self.row_at(self.driven_m(last) - TURNING_LOOP_M).max(start);
        self.halt_on_visit(first..last + 1, place, terminus)
    }

    /// Returns the first halt at a known terminus after another halt, before row `end`; `None` if
    /// the bus was not there.
    fn halt_after(
        &self,
        halt: &Halt,
        termini: &Termini,
        terminus: usize,
        end: usize,
    ) -> Option<Halt> {
        let place = termini.place(terminus);
        let first = (halt.rows.end..end).find(|&row| self.offset_m(row, place) < VISIT_M)?;
        let last = self
            .row_at(self.driven_m(first) + TURNING_LOOP_M)
            .min(end - 1);
        self.halt_on_visit(first..last + 1, place, terminus)
    }

    /// Returns the longest wait at a terminus, else the row nearest to it.
    fn halt_on_visit(
        &self,
        visit: Range<usize>,
        place: (f64, f64),
        terminus: usize,
    ) -> Option<Halt> {
        let nearest = visit
            .clone()
            .min_by(|&a, &b| self.offset_m(a, place).total_cmp(&self.offset_m(b, place)))?;
        let rows = self
            .longest_wait(visit, |row| self.offset_m(row, place) < VISIT_M)
            .unwrap_or(nearest..nearest + 1);
        Some(Halt { rows, terminus })
    }

    /// Returns the distance of the bus from a place, m; infinite without a fix.
    fn offset_m(&self, row: usize, place: (f64, f64)) -> f64 {
        self.plane_m[row].map_or(f64::INFINITY, |here| distance_m(here, place))
    }

    /// Returns the drive from the first fix on, as one trip.
    fn whole(&self) -> (Halt, Halt) {
        let halt = |row: usize, terminus| Halt {
            rows: row..row + 1,
            terminus,
        };
        (
            halt(self.mission.first_fix, 0),
            halt(self.mission.rows.len() - 1, 1),
        )
    }

    fn pass(&self, direction: PassDirection, from: Halt, to: Halt) -> Pass {
        let (first, last) = (from.rows.end - 1, to.rows.start);
        let all = &self.mission.rows;
        let altitude_m =
            |rows: &Range<usize>| mean(all[rows.clone()].iter().filter_map(|row| row.altitude_m));
        Pass {
            direction,
            rows: first..last + 1,
            start_s: all[first].time_s,
            duration_s: all[last].time_s - all[first].time_s,
            length_m: self.driven_m(last) - self.driven_m(first),
            climb_m: altitude_m(&to.rows)
                .zip(altitude_m(&from.rows))
                .map(|(end, start)| end - start),
            passengers_mean: mean(all[first..=last].iter().filter_map(|row| row.passengers)),
            from,
            to,
        }
    }
}

/// The termini found so far, by place.
#[derive(Default)]
struct Termini(Vec<(f64, f64)>);

impl Termini {
    /// Returns the number of the terminus at this place, a new one if none is near.
    fn index(&mut self, place: (f64, f64)) -> usize {
        let known = self
            .0
            .iter()
            .position(|&other| distance_m(place, other) < TERMINUS_M);
        known.unwrap_or_else(|| {
            self.0.push(place);
            self.0.len() - 1
        })
    }

    fn place(&self, terminus: usize) -> (f64, f64) {
        self.0[terminus]
    }
}

fn distance_m(a: (f64, f64), b: (f64, f64)) -> f64 {
    (a.0 - b.0).hypot(a.1 - b.1)
}

fn mean(values: impl Iterator<Item = f64>) -> Option<f64> {
    let (sum, count) = values.fold((0.0, 0_u32), |(sum, n), v| (sum + v, n + 1));
    (count > 0).then(|| sum / f64::from(count))
}
