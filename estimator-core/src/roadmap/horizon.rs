//! The grade ahead.

use super::join::Join;
use super::map_error::MapError;
use super::matcher::MapPlace;
use super::packed_map::{MapWay, PackedMap};
use super::plane::{Lines, dot};
use super::profile::Profile;
use crate::cell::{CELL_LENGTH_M, Uncertain};
use heapless::Vec;

/// Most branches of a horizon, the most probable path among them.
pub const MOST_BRANCHES: usize = 4;
/// Most ways that one path goes along.
const MOST_WAYS: usize = 16;
/// Probability that a vehicle stays on a way that goes on where another one leaves it. There is no
/// route to know better.
const STAYS: f32 = 0.9;
/// A join this near to the end of a way is one at its end, cells.
const AT_END_CELLS: i32 = 4;

/// A path ahead of the vehicle: stretches of ways.
#[derive(Clone, Debug)]
pub struct Branch {
    /// Distance from the vehicle at which it leaves the path before it, m; 0 for the first branch.
    pub from_m: f32,
    /// Probability that the vehicle takes it, seen from here.
    pub probability: f32,
    stretches: Vec<Stretch, MOST_WAYS>,
}

/// A part of a way.
#[derive(Clone, Copy, Debug)]
struct Stretch {
    block: u32,
    /// Where it begins on the way.
    cell: f32,
    /// Distance of the beginning from the vehicle, m.
    from_m: f32,
}

/// The paths ahead of a place, up to a distance.
#[derive(Clone, Debug)]
pub struct Horizon<'m> {
    map: PackedMap<'m>,
    sigma_m: f32,
    length_m: f32,
    branches: Vec<Branch, MOST_BRANCHES>,
    /// What leaves the first branch: where, and with which probability.
    forks: Vec<(Stretch, f32), MOST_BRANCHES>,
}

/// A place ahead.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HorizonPoint {
    /// Distance from the vehicle, m.
    pub ahead_m: f32,
    /// Grade there, %; `None` where the map has none.
    pub grade_percent: Option<Uncertain>,
}

/// Reads the grades of a branch, one after the other.
#[derive(Clone, Debug)]
pub(super) struct GradeReader<'m> {
    step_m: f32,
    /// Number of the next point, and that behind the last one.
    next: u32,
    end: u32,
    stretches_begun: usize,
    here: Option<(Stretch, Option<Profile<'m>>)>,
}

impl<'m> Horizon<'m> {
    /// Returns the paths ahead of a place. The first one is the most probable.
    ///
    /// # Errors
    /// Returns an error if the map is damaged here. Where it is damaged ahead, a branch ends.
    pub fn new(map: PackedMap<'m>, place: &MapPlace, length_m: f32) -> Result<Self, MapError> {
        let mut horizon = Self::begin(map, place, length_m);
        while horizon.extend()? {}
        Ok(horizon)
    }

    /// Begins at a place. [`extend`](Self::extend) then follows the paths.
    pub(super) fn begin(map: PackedMap<'m>, place: &MapPlace, length_m: f32) -> Self {
        let start = Stretch {
            block: place.block,
            cell: place.cell,
            from_m: 0.0,
        };
        let mut horizon = Self {
            map,
            sigma_m: place.sigma_m,
            length_m,
            branches: Vec::new(),
            forks: Vec::new(),
        };
        horizon.begin_branch(start, place.probability);
        horizon
    }

    /// Follows a path to the end of a way: the work of a step is bounded. Returns false when all
    /// paths are followed.
    ///
    /// # Errors
    /// Returns an error if the map is damaged on the way of the vehicle.
    pub(super) fn extend(&mut self) -> Result<bool, MapError> {
        match self.follow() {
            Ok(true) => return Ok(true),
            // What lies ahead of the damage is not known, what leaves the road before it is.
            Err(error) if self.is_begun() => return Err(error),
            Ok(false) | Err(_) => {}
        }
        let Some((stretch, probability)) = self.forks.get(self.branches.len().saturating_sub(1))
        else {
            return Ok(false);
        };
        let (stretch, probability) = (*stretch, *probability);
        Ok(self.begin_branch(stretch, probability))
    }

    /// Returns whether it is still on the way of the vehicle.
    fn is_begun(&self) -> bool {
        matches!(self.branches.as_slice(), [first] if first.stretches.len() == 1)
    }

    /// Returns the branches.
    #[must_use]
    pub fn branches(&self) -> &[Branch] {
        &self.branches
    }

    /// Returns the length, m.
    pub(super) const fn length_m(&self) -> f32 {
        self.length_m
    }

    /// Returns the grades of a branch, every `step_m` metres of distance from the vehicle, from where
    /// it begins on.
    pub fn points<'h>(
        &'h self,
        branch: &'h Branch,
        step_m: f32,
    ) -> impl Iterator<Item = HorizonPoint> + use<'h, 'm> {
        let mut reader = self.reader(branch, step_m);
        core::iter::from_fn(move || self.next_point(branch, &mut reader))
    }

    /// Returns a reader of the grades of a branch, every `step_m` metres.
    pub(super) fn reader(&self, branch: &Branch, step_m: f32) -> GradeReader<'m> {
        GradeReader {
            step_m,
            next: libm::ceilf(branch.from_m / step_m) as u32,
            end: libm::floorf(self.length_m / step_m) as u32 + 1,
            stretches_begun: 0,
            here: None,
        }
    }

    /// Reads the next point of a branch; `None` behind the last one.
    pub(super) fn next_point(
        &self,
        branch: &Branch,
        reader: &mut GradeReader<'m>,
    ) -> Option<HorizonPoint> {
        if reader.next >= reader.end {
            return None;
        }
        let ahead_m = reader.next as f32 * reader.step_m;
        reader.next += 1;
        let behind = branch.stretches.iter().skip(reader.stretches_begun);
        let begun = behind.take_while(|stretch| stretch.from_m <= ahead_m);
        let (count, newest) = begun.fold((0, None), |(count, _), begun| (count + 1, Some(*begun)));
        reader.stretches_begun += count;
        if let Some(stretch) = newest {
            let profile = Profile::new(self.map, stretch.block, stretch.cell);
            reader.here = Some((stretch, profile));
        }
        let grade_percent = reader.here.as_mut().and_then(|(stretch, profile)| {
            let profile = profile.as_mut()?;
            let cell = stretch.cell + (ahead_m - stretch.from_m) / CELL_LENGTH_M;
            profile
                .seek(cell)
                .then(|| profile.grade_percent(cell, self.sigma_m))
                .flatten()
        });
        Some(HorizonPoint {
            ahead_m,
            grade_percent,
        })
    }

    /// Begins a branch. Returns false if there are as many as there can be.
    fn begin_branch(&mut self, stretch: Stretch, probability: f32) -> bool {
        let mut stretches = Vec::new();
        let _ = stretches.push(stretch);
        let branch = Branch {
            from_m: stretch.from_m,
            probability,
            stretches,
        };
        self.branches.push(branch).is_ok()
    }

    /// Follows the newest branch along its way, to the most probable way behind it. Notes what leaves
    /// the first branch. Returns false if the branch ends.
    fn follow(&mut self) -> Result<bool, MapError> {
        let is_first = self.branches.len() == 1;
        let Some((here, mut left)) = self.branches.last().and_then(|branch| {
            let here = branch.stretches.last()?;
            Some((*here, branch.probability))
        }) else {
            return Ok(false);
        };
        let way = self.map.way(self.map.block(here.block)?.way)?;
        let ahead_m = |cell: i32| here.from_m + (cell as f32 - here.cell) * CELL_LENGTH_M;
        let mut at_end: Vec<Join, MOST_BRANCHES> = Vec::new();
        let mut fork = |join: &Join, probability: f32| {
            if is_first {
                let fork = stretch(join, ahead_m(join.at_cell));
                let _ = self.forks.push((fork, probability));
            }
        };
        for join in self.map.joins_from(&way, here.cell) {
            // Behind a damaged join, the way goes on, and no other leaves it.
            let Ok(join) = join else { break };
            if ahead_m(join.at_cell) > self.length_m {
                break;
            }
            if join.at_cell < way.last_cell - AT_END_CELLS {
                fork(&join, left * (1.0 - STAYS));
                left *= STAYS;
            } else {
                let _ = at_end.push(join);
            }
        }
        let straight = straightest(&self.map, &way, here.block, &at_end);
        if let Some(straight) = straight {
            let others = at_end.iter().filter(|join| **join != straight);
            let count = others.clone().count() as f32;
            for join in others {
                fork(join, left * (1.0 - STAYS) / count);
            }
            if count > 0.0 {
                left *= STAYS;
            }
        }
        let next = straight.map(|join| stretch(&join, ahead_m(join.at_cell)));
        let Some(branch) = self.branches.last_mut() else {
            return Ok(false);
        };
        branch.probability = left;
        Ok(next.is_some_and(|next| branch.stretches.push(next).is_ok()))
    }
}

/// Returns the join that leads straight on, of those at the end of a way; `None` if one of them leads
/// to a damaged way, which may be it. The way is driven in a block near its end.
fn straightest(map: &PackedMap<'_>, way: &MapWay<'_>, block: u32, joins: &[Join]) -> Option<Join> {
    let [first, others @ ..] = joins else {
        return None;
    };
    if others.is_empty() {
        return Some(*first);
    }
    let out = end_direction(map, way, block);
    let cosine = |join: &Join| {
        let entered = map.block(join.to_block).ok()?;
        let on = Lines::of(&entered)?.next()?;
        Some(dot(out?, on.directed().direction))
    };
    let mut best = (*first, cosine(first)?);
    for join in others {
        let cosine = cosine(join)?;
        if cosine > best.1 {
            best = (*join, cosine);
        }
    }
    Some(best.0)
}

/// Returns the direction in which a way ends.
fn end_direction(map: &PackedMap<'_>, way: &MapWay<'_>, block: u32) -> Option<[f32; 2]> {
    let last = map.blocks_from(way, block).last()?.ok()?;
    Some(Lines::of(&last)?.last()?.directed().direction)
}

/// Returns the stretch that a join leads to.
fn stretch(join: &Join, from_m: f32) -> Stretch {
    Stretch {
        block: join.to_block,
        cell: join.to_cell as f32,
        from_m,
    }
}
