//! The grade ahead.

use super::joins::Join;
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
}

/// A place ahead.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HorizonPoint {
    /// Distance from the vehicle, m.
    pub ahead_m: f32,
    /// Grade there, %; `None` where the map has none.
    pub grade_percent: Option<Uncertain>,
}

impl<'m> Horizon<'m> {
    /// Returns the paths ahead of a place. The first one is the most probable.
    ///
    /// # Errors
    /// Returns an error if the map is damaged here.
    pub fn new(map: PackedMap<'m>, place: &MapPlace, length_m: f32) -> Result<Self, MapError> {
        let mut horizon = Self {
            map,
            sigma_m: place.sigma_m,
            length_m,
            branches: Vec::new(),
        };
        let start = Stretch {
            block: place.block,
            cell: place.cell,
            from_m: 0.0,
        };
        let mut forks: Vec<(Stretch, f32), MOST_BRANCHES> = Vec::new();
        let first = horizon.path(start, 0.0, place.probability, |stretch, probability| {
            let _ = forks.push((stretch, probability));
        })?;
        let _ = horizon.branches.push(first);
        for (stretch, probability) in forks {
            let branch = horizon.path(stretch, stretch.from_m, probability, |_, _| {})?;
            let _ = horizon.branches.push(branch);
        }
        Ok(horizon)
    }

    /// Returns the branches.
    #[must_use]
    pub fn branches(&self) -> &[Branch] {
        &self.branches
    }

    /// Returns the grades of a branch, every `step_m` metres of distance from the vehicle, from where
    /// it begins on.
    pub fn points<'h>(
        &'h self,
        branch: &'h Branch,
        step_m: f32,
    ) -> impl Iterator<Item = HorizonPoint> + use<'h, 'm> {
        let first = libm::ceilf(branch.from_m / step_m) as u32;
        let last = libm::floorf(self.length_m / step_m) as u32;
        let mut stretches = branch.stretches.iter().peekable();
        let mut here: Option<(Stretch, Option<Profile<'m>>)> = None;
        (first..=last).map(move |number| {
            let ahead_m = number as f32 * step_m;
            while let Some(next) = stretches.next_if(|next| next.from_m <= ahead_m) {
                here = Some((*next, Profile::new(self.map, next.block, next.cell)));
            }
            let grade_percent = here.as_mut().and_then(|(stretch, profile)| {
                let profile = profile.as_mut()?;
                let cell = stretch.cell + (ahead_m - stretch.from_m) / CELL_LENGTH_M;
                profile
                    .seek(cell)
                    .then(|| profile.grade_percent(cell, self.sigma_m))
                    .flatten()
            });
            HorizonPoint {
                ahead_m,
                grade_percent,
            }
        })
    }

    /// Follows the most probable path from a place. Calls `fork` with what leaves it.
    fn path(
        &self,
        start: Stretch,
        from_m: f32,
        probability: f32,
        mut fork: impl FnMut(Stretch, f32),
    ) -> Result<Branch, MapError> {
        let mut branch = Branch {
            from_m,
            probability,
            stretches: Vec::new(),
        };
        let mut here = start;
        let mut left = probability;
        while branch.stretches.push(here).is_ok() {
            let way = self.map.way(self.map.block(here.block)?.way)?;
            let ahead_m = |cell: i32| here.from_m + (cell as f32 - here.cell) * CELL_LENGTH_M;
            let mut best: Option<(Join, f32)> = None;
            let mut at_end: Vec<(Join, f32), MOST_BRANCHES> = Vec::new();
            for join in self.map.joins_from(&way, here.cell) {
                let join = join?;
                let join_m = ahead_m(join.at_cell);
                if join_m > self.length_m {
                    break;
                }
                if join.at_cell < way.last_cell - AT_END_CELLS {
                    fork(stretch(&join, join_m), left * (1.0 - STAYS));
                    left *= STAYS;
                    continue;
                }
                let cosine = self.cosine(&way, here.block, &join).unwrap_or(-1.0);
                let _ = at_end.push((join, cosine));
                if best.is_none_or(|(_, most)| cosine > most) {
                    best = Some((join, cosine));
                }
            }
            let Some((straight, _)) = best else { break };
            let others = at_end.iter().filter(|(join, _)| *join != straight);
            let count = others.clone().count() as f32;
            for (join, _) in others {
                fork(
                    stretch(join, ahead_m(join.at_cell)),
                    left * (1.0 - STAYS) / count,
                );
            }
            if count > 0.0 {
                left *= STAYS;
            }
            here = stretch(&straight, ahead_m(straight.at_cell));
            if here.from_m > self.length_m {
                break;
            }
        }
        branch.probability = left;
        Ok(branch)
    }

    /// Returns the cosine of the turn at a join at the end of a way, which is driven in a block near
    /// its end.
    fn cosine(&self, way: &MapWay<'m>, block: u32, join: &Join) -> Option<f32> {
        let last = self.map.blocks_from(way, block).last()?.ok()?;
        let entered = self.map.block(join.to_block).ok()?;
        let out = Lines::of(&last)?.last()?;
        let on = Lines::of(&entered)?.next()?;
        Some(dot(out.direction, on.direction))
    }
}

/// Returns the stretch that a join leads to.
fn stretch(join: &Join, from_m: f32) -> Stretch {
    Stretch {
        block: join.to_block,
        cell: join.to_cell as f32,
        from_m,
    }
}
