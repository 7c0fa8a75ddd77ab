//! Where the vehicle is on the map: several hypotheses, moved by the odometer and compared with
//! positions and course.
//!
//! A hypothesis is a place on a way. At each join it splits: one part stays on the way, one takes
//! the join. Positions tell which fits. In a tunnel, all go on with the odometer. Away from the map,
//! or where all hypotheses are poor, the index gives new ones near the position. The work per cell
//! is bounded: positions are compared every 10 m, and the index is searched tile by tile. Each waits
//! for a call in which no block is read and the other has no turn.

use super::along::Along;
use super::block::Block;
use super::packed_map::PackedMap;
use super::path::{Moved, Path, cells_of, nearest_place};
use super::plane::{Foot, direction, dot, metres_between};
use super::search::{BLOCK_WORK, Search, WORK_AT_ONCE};
use super::tile::Looked;
use crate::cell::{CELL_LENGTH_M, CellEnd};
use crate::scalar::Scalar;
use core::mem;
use heapless::Vec;
use libm::expf;

/// Most hypotheses.
pub(super) const MOST_PATHS: usize = 6;
/// Cells from one comparison with a position to the next.
const UPDATE_CELLS: u32 = 4;
/// Most cells for which a comparison or a search waits until no block is read.
const LATEST_CELLS: u32 = 8;
/// A course is the chord of the last two comparisons. It is at least so long, m.
const COURSE_M: f32 = 10.0;
/// Distance over which misfits are averaged, m.
const MEMORY_M: f32 = 200.0;
/// Standard deviation of a position across the way, m: lanes, position error, offset of the map.
const ACROSS_SIGMA_M: f32 = 6.0;
/// Standard deviation along it, m. More than the noise: the place follows slowly.
const AHEAD_SIGMA_M: f32 = 15.0;
/// Cost of a course across the way.
const COURSE_COST: f32 = 30.0;
/// Largest misfit of one position.
const WORST: f32 = 25.0;
/// A hypothesis whose misfit is larger is dropped ...
const DROPPED: f32 = 9.0;
/// ... or by this larger than that of the best one ...
const DROPPED_BESIDE: f32 = 4.0;
/// ... after this distance, m.
const TRIED_M: f32 = 50.0;
/// The place counts as known after this distance, m, with at most this misfit, at this probability.
const KNOWN_M: f32 = 100.0;
const KNOWN_MISFIT: f32 = 4.0;
const KNOWN_PROBABILITY: f32 = 0.9;
/// Comparisons after a fork before one of several ways is the place.
const KNOWN_COMPARISONS: u8 = 2;
/// Distance over which a new hypothesis is compared before it makes an older one unclear, m.
const COUNTED_M: f32 = 20.0;
/// Independent positions within the memory.
const INDEPENDENT: f32 = 3.0;
/// Hypotheses within this distance on one way are one, cells.
const SAME_CELLS: f32 = 12.0;
/// Largest distance of a new hypothesis from the position, m.
const REACH_M: f32 = 30.0;
/// Least cosine between the course and the way of a new hypothesis.
const COURSE_COSINE: f32 = 0.8;
/// Farther away than the reach by the rounding of a distance, m.
const BEYOND_REACH_M: f32 = REACH_M + 1.0;
/// Distance between two searches of the index while a place is known, m.
const SEARCH_M: f32 = 100.0;
/// Without a comparison for this distance, the place is no longer known, m.
const BLIND_M: f32 = 20_000.0;
/// Most cells in one advance. After a longer gap nothing is known.
const MOST_CELLS: u32 = 400;

/// A place on the map.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MapPlace {
    /// Offset of the way.
    pub way: u32,
    /// Offset of the block.
    pub block: u32,
    /// Where along the way: the number of a cell, and a part of one.
    pub cell: f32,
    /// Standard deviation along the way, m.
    pub sigma_m: f32,
    /// Probability that the vehicle is on this way, among the ways of the map.
    pub probability: f32,
}

/// Where the vehicle is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum MapMatch {
    /// On the map, at this place.
    On(MapPlace),
    /// Perhaps on the map: too early to tell, or several ways fit.
    Unclear,
    /// Not on the map.
    Off,
}

/// Follows the vehicle on a map.
#[derive(Clone, Debug)]
pub struct Matcher<'m> {
    pub(super) map: PackedMap<'m>,
    pub(super) paths: Vec<Path<'m>, MOST_PATHS>,
    pub(super) search: Option<Search<'m>>,
    /// Blocks were read since the last advance.
    pub(super) has_read: bool,
    pub(super) state: MatcherState,
}

/// What a matcher knows beside its map.
#[derive(Clone, Copy, Debug)]
pub(super) struct MatcherState {
    pub(super) along: Along,
    cell: Option<u32>,
    updated_cell: u32,
    /// The index is searched, in calls without a comparison.
    looks: bool,
    /// The last call with either was a comparison. A search comes next, even if the calls are as rare
    /// as comparisons.
    has_compared: bool,
    /// The positions of the last two comparisons, the older one first.
    recent_e7: [Option<(i32, i32)>; 2],
    course: Option<[f32; 2]>,
    searched_m: f32,
    blind_m: f32,
}

impl MatcherState {
    pub(super) fn new() -> Self {
        Self {
            along: Along::new(),
            cell: None,
            updated_cell: 0,
            looks: false,
            has_compared: false,
            recent_e7: [None; 2],
            course: None,
            searched_m: f32::INFINITY,
            blind_m: 0.0,
        }
    }

    /// Returns whether a cell lies before the newest: another estimator has begun the next drive.
    pub(super) fn is_next_drive(&self, end: &CellEnd) -> bool {
        self.cell.is_some_and(|cell| end.cell < cell)
    }
}

impl<'m> Matcher<'m> {
    /// Creates a matcher that does not know where the vehicle is.
    #[must_use]
    pub fn new(map: PackedMap<'m>) -> Self {
        Self {
            map,
            paths: Vec::new(),
            search: None,
            has_read: false,
            state: MatcherState::new(),
        }
    }

    /// Returns the map.
    #[must_use]
    pub const fn map(&self) -> &PackedMap<'m> {
        &self.map
    }

    /// Forgets where the vehicle is.
    pub(super) fn forget(&mut self) {
        self.paths.clear();
        self.search = None;
        self.state = MatcherState::new();
    }

    /// Moves on to the end of a cell.
    pub fn advance(&mut self, end: &CellEnd) {
        let cells = self
            .state
            .cell
            .map_or(1, |cell| end.cell.saturating_sub(cell));
        self.state.cell = Some(end.cell);
        if cells > MOST_CELLS {
            self.paths.clear();
        }
        let metres = CELL_LENGTH_M * cells as f32;
        self.has_read |= self.move_paths(cells as f32);
        self.state.along.advance(metres);
        self.state.blind_m += metres;
        self.state.searched_m += metres;
        if self.state.blind_m > BLIND_M {
            self.paths.clear();
        }
        let since = end.cell.saturating_sub(self.state.updated_cell);
        if mem::take(&mut self.has_read) && since < LATEST_CELLS {
            return;
        }
        let is_due = since >= UPDATE_CELLS;
        if self.state.looks && (!is_due || self.state.has_compared) {
            self.state.looks = self.look_around(end.cell);
            self.state.has_compared = false;
        } else if is_due {
            self.take_position(end, since);
            self.state.has_compared = true;
        }
    }

    /// Takes a position, cells after the last one.
    fn take_position(&mut self, end: &CellEnd, since: u32) {
        let Some(position_e7) = end.position_e7 else {
            self.state.recent_e7 = [None; 2];
            return;
        };
        let between_m = CELL_LENGTH_M * since as f32;
        self.state.updated_cell = end.cell;
        self.measure_course(position_e7);
        if let Some(course) = self.state.course {
            self.compare(position_e7, course, Scalar::min(MEMORY_M, between_m));
            self.state.looks = true;
        }
    }

    /// Returns where the vehicle is.
    #[must_use]
    pub fn place(&self) -> MapMatch {
        match self.known() {
            Some((path, probability)) => MapMatch::On(self.place_of(path, probability)),
            None if self.paths.is_empty() => MapMatch::Off,
            None => MapMatch::Unclear,
        }
    }

    /// Returns the hypothesis that is surely right, with its probability.
    fn known(&self) -> Option<(&Path<'m>, f32)> {
        let best = self.best()?;
        let is_tried = best.fit.matched_m >= KNOWN_M
            && best.fit.misfit <= KNOWN_MISFIT
            && best.fit.compared >= KNOWN_COMPARISONS;
        if !is_tried {
            return None;
        }
        let probability = self.probability(best);
        (probability >= KNOWN_PROBABILITY).then_some((best, probability))
    }

    /// Returns the hypotheses, with their probabilities.
    pub fn hypotheses(&self) -> impl Iterator<Item = MapPlace> {
        self.paths
            .iter()
            .map(|path| self.place_of(path, self.probability(path)))
    }

    fn place_of(&self, path: &Path<'m>, probability: f32) -> MapPlace {
        MapPlace {
            way: path.block.way,
            block: path.block.offset,
            cell: path.cell(),
            sigma_m: self.state.along.sigma_m(),
            probability,
        }
    }

    fn best(&self) -> Option<&Path<'m>> {
        self.paths
            .iter()
            .min_by(|a, b| a.fit.misfit.total_cmp(&b.fit.misfit))
    }

    /// Returns the probability of a hypothesis among all.
    fn probability(&self, path: &Path<'m>) -> f32 {
        if self.paths.len() == 1 {
            return 1.0;
        }
        let weight = |other: &Path<'m>| {
            let better = path.fit.misfit - other.fit.misfit;
            // That of the hypothesis itself: an exponential costs more than all of the rest.
            if better == 0.0 {
                return 1.0;
            }
            expf((0.5 * INDEPENDENT * better).clamp(-80.0, 80.0))
        };
        let count =
            |other: &&Path<'m>| other.fit.matched_m >= Scalar::min(COUNTED_M, path.fit.matched_m);
        1.0 / Scalar::max(1.0, self.paths.iter().filter(count).map(weight).sum())
    }

    /// Moves all hypotheses, and splits them at joins. Returns whether blocks were read for it.
    fn move_paths(&mut self, cells: f32) -> bool {
        let cells = cells * (1.0 + self.state.along.scale);
        let map = self.map;
        let mut forks: Vec<Path<'m>, MOST_PATHS> = Vec::new();
        let mut has_read = false;
        self.paths.retain_mut(|path| {
            let (misfit, matched_m) = (path.fit.misfit, path.fit.matched_m);
            let directions = path.fit.directions;
            let block = path.block.offset;
            let moved = path.advance(&map, cells, |join, beyond| {
                let cell = join.to_cell as f32 + beyond;
                if let Ok(mut fork) = Path::new(&map, join.to_way, join.to_block, cell) {
                    fork.fit.misfit = misfit;
                    fork.fit.matched_m = matched_m;
                    fork.fit.directions = directions;
                    let _ = forks.push(fork);
                }
            });
            has_read |= path.block.offset != block;
            moved == Moved::On
        });
        // By reference: the iterator of the vector itself can panic, as far as the compiler knows.
        for fork in &forks {
            self.add(fork.clone());
        }
        if let [only] = self.paths.as_mut_slice() {
            // There is nothing to tell it apart from.
            only.fit.compared = only.fit.compared.max(KNOWN_COMPARISONS);
        }
        has_read || !forks.is_empty()
    }

    /// Adds a hypothesis unless there is one at its place. The poorest one makes room.
    #[inline(never)] // Rare, and called from two places.
    fn add(&mut self, path: Path<'m>) {
        if self
            .paths
            .iter()
            .any(|known| known.is_at(&path, SAME_CELLS))
        {
            return;
        }
        if let Err(path) = self.paths.push(path)
            && let Some(poorest) = self
                .paths
                .iter_mut()
                .max_by(|a, b| a.fit.misfit.total_cmp(&b.fit.misfit))
            && poorest.fit.misfit > path.fit.misfit
        {
            *poorest = path;
        }
    }

    /// Measures the course from the position before the last one.
    fn measure_course(&mut self, position_e7: (i32, i32)) {
        let [from, last] = self.state.recent_e7;
        self.state.recent_e7 = [last, Some(position_e7)];
        let Some(from) = from else {
            return;
        };
        if let Some(course) = direction(metres_between(from, position_e7), COURSE_M) {
            self.state.course = Some(course);
        }
    }

    /// Compares all hypotheses with a position, and drops the poor ones.
    #[inline(never)] // Its room on the stack is not that of a search.
    fn compare(&mut self, position_e7: (i32, i32), course: [f32; 2], metres: f32) {
        let gain = self.state.along.update();
        let mut best: Option<(f32, f32)> = None;
        for path in &mut self.paths {
            let Some(foot) = path.foot(position_e7) else {
                continue;
            };
            let chord = path.chord(foot.direction);
            // Not `f32::min`, which a controller calls as a function.
            let now = Scalar::min(WORST, misfit(&foot, chord, course));
            let matched_m = path.fit.matched_m + metres;
            let memory_m = Scalar::max(metres, Scalar::min(MEMORY_M, matched_m));
            path.fit.misfit += (now - path.fit.misfit) * metres / memory_m;
            path.fit.matched_m = Scalar::min(1e6, matched_m);
            path.fit.compared = path.fit.compared.saturating_add(1);
            let ahead_m = foot.ahead_m.clamp(-AHEAD_SIGMA_M, AHEAD_SIGMA_M);
            path.at_cells += cells_of(gain.place * ahead_m);
            if best.is_none_or(|(misfit, _)| path.fit.misfit < misfit) {
                best = Some((path.fit.misfit, ahead_m));
            }
        }
        if let Some((least, ahead_m)) = best {
            self.state.blind_m = 0.0;
            self.state.along.learn(gain, ahead_m);
            self.paths.retain(|path| {
                path.fit.matched_m < TRIED_M
                    || (path.fit.misfit < DROPPED && path.fit.misfit < least + DROPPED_BESIDE)
            });
        }
        self.merge();
    }

    /// Drops hypotheses that have come to the place of a better one.
    fn merge(&mut self) {
        if self.paths.len() < 2 {
            return;
        }
        let mut kept: Vec<Path<'m>, MOST_PATHS> = Vec::new();
        for path in &self.paths {
            match kept
                .iter_mut()
                .find(|known| known.is_at(path, 0.5 * SAME_CELLS))
            {
                Some(known) if path.fit.misfit < known.fit.misfit => *known = path.clone(),
                Some(_) => {}
                None => {
                    let _ = kept.push(path.clone());
                }
            }
        }
        self.paths = kept;
    }

    /// Looks for other ways near the last position, a few blocks at once. Returns whether there is
    /// more to look at.
    #[inline(never)] // Its room on the stack is not that of a comparison.
    fn look_around(&mut self, cell: u32) -> bool {
        if self.search.is_none() && self.state.searched_m < SEARCH_M && self.known().is_some() {
            return false;
        }
        let search = match (&mut self.search, self.state.recent_e7[1], self.state.course) {
            (Some(search), _, _) => search,
            (None, Some(position_e7), Some(course)) => {
                self.state.searched_m = 0.0;
                let from = self.state.updated_cell;
                self.search
                    .insert(Search::begin(&self.map, position_e7, course, from))
            }
            _ => return false,
        };
        let mut work = WORK_AT_ONCE;
        while work >= BLOCK_WORK {
            let (looked, cost) = search.look();
            work = work.saturating_sub(cost);
            let offset = match looked {
                Looked::Block(offset) => offset,
                Looked::NotYet => continue,
                Looked::End => {
                    self.search = None;
                    return false;
                }
            };
            if self.paths.iter().any(|path| path.block.offset == offset) {
                // The hypothesis there is followed.
                continue;
            }
            // It is checked if it is near.
            let Ok(block) = self.map.block_again(offset) else {
                continue;
            };
            if let Some(path) = candidate(&self.map, &block, search, cell) {
                if self.paths.is_empty() {
                    self.state.along.restart();
                }
                self.add(path);
                return true;
            }
        }
        true
    }
}

/// Returns a new hypothesis on a block, if the position of the search is near it.
fn candidate<'m>(
    map: &PackedMap<'m>,
    block: &Block<'m>,
    search: &Search<'m>,
    cell: u32,
) -> Option<Path<'m>> {
    let (at_cells, foot) = nearest_place(
        block,
        search.around.position_e7,
        search.around.course,
        COURSE_COSINE,
        BEYOND_REACH_M,
    )?;
    if foot.distance_m() > REACH_M {
        return None;
    }
    let block = map.block(block.offset).ok()?;
    let way = map.way(block.way).ok()?;
    let driven = cell.saturating_sub(search.around.cell) as f32;
    let mut path = Path::in_block(map, &way, block, at_cells + driven).ok()?;
    path.fit.misfit = misfit(&foot, foot.direction, search.around.course);
    Some(path)
}

/// Returns how badly a position and a course fit, in standard deviations squared.
/// `direction` is that of the way over the chord of the course.
fn misfit(foot: &Foot, direction: [f32; 2], course: [f32; 2]) -> f32 {
    let square = |x: f32| x * x;
    let cosine = dot(course, direction);
    square(foot.left_m / ACROSS_SIGMA_M)
        + square(foot.ahead_m / AHEAD_SIGMA_M)
        + COURSE_COST * (1.0 - cosine)
}
