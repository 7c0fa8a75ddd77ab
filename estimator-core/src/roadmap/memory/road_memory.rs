//! The road memory of a vehicle.

use super::flash::MappedFlash;
use super::fusion::Parts;
use super::learner::Learner;
use super::memory_counters::MemoryCounters;
use super::parked::ParkedMatcher;
use super::sectors::SectorTable;
use super::store::{MemoryError, Opened, Store};
use super::view::MemoryView;
use crate::cell::{Cell, Live, Uncertain};
use crate::roadmap::map_judge::{MapCounters, MapJudge};
use crate::roadmap::map_limits::MapLimits;
use crate::roadmap::matcher::{MapMatch, MapPlace, Matcher};
use crate::roadmap::packed_map::PackedMap;
use crate::roadmap::profile::{ParkedProfile, Profile};

/// The grade of the memory where the vehicle is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MemoryGrade {
    /// The grade, %, with the error of the place.
    pub grade_percent: Uncertain,
    /// Part of its variance that the vehicle's live grade has too, %².
    pub common_variance: f32,
}

/// A vehicle that learns the roads that it drives.
///
/// It stands beside the estimator as a map does: [`advance`](Self::advance) takes the live estimate
/// after each step, [`finish`](Self::finish) each finished cell. `F` is the flash memory, `R` the RAM
/// for what is known of its sectors: as many [`Sector`](super::Sector)s as the flash memory has.
#[derive(Clone, Debug)]
pub struct RoadMemory<F, R> {
    store: Store<F, R>,
    matcher: ParkedMatcher,
    judge: MapJudge,
    learner: Learner,
    place: MapMatch,
    grade: Option<MemoryGrade>,
    /// Where the grade was read, and how often the roads had changed then.
    profile: Option<(u32, ParkedProfile)>,
    counts: bool,
}

impl<F: MappedFlash, R: SectorTable> RoadMemory<F, R> {
    /// Opens the memory at the begin of a drive. What is damaged is left out.
    ///
    /// # Errors
    /// [`MemoryError::Size`] if the flash memory is too small or too large, if its sectors are too
    /// large, or if `sectors` has another number of them.
    pub fn open(flash: F, sectors: R) -> Result<Self, MemoryError<F::Error>> {
        Ok(Self {
            store: Store::open(flash, sectors)?,
            matcher: ParkedMatcher::new(),
            judge: MapJudge::new(MapLimits::MEMORY),
            learner: Learner::new(),
            place: MapMatch::Off,
            grade: None,
            profile: None,
            counts: false,
        })
    }

    /// Returns what the memory held when it was opened.
    #[must_use]
    pub const fn opened(&self) -> &Opened {
        self.store.opened()
    }

    /// Returns its roads, for a [`PackedMap`] and a horizon.
    #[must_use]
    pub fn view(&self) -> MemoryView<'_> {
        self.store.view()
    }

    /// Moves on to the live estimate at the end of a cell.
    pub fn advance(&mut self, live: &Live) {
        if self.matcher.is_next_drive(&live.end) {
            self.matcher.forget();
            self.judge.begin_drive();
            self.learner.begin_drive(&mut self.store);
        }
        let changes = self.store.changes();
        let map = PackedMap::of_memory(self.store.view());
        let mut matcher = Matcher::new(map);
        self.matcher.resume(&mut matcher, changes);
        matcher.advance(&live.end);
        self.place = matcher.place();
        let parked = self.profile.take();
        self.grade = None;
        if let MapMatch::On(place) = &self.place {
            let parked = parked.filter(|(at, _)| *at == changes);
            let profile = profile_at(map, place, parked.map(|(_, parked)| parked));
            self.profile = profile.as_ref().map(|profile| (changes, profile.park()));
            let sigma_m = self.judge.alignment().with_shift(place.sigma_m);
            self.grade = profile.and_then(|profile| grade_at(&profile, place.cell, sigma_m));
        }
        let scale = 1.0 + matcher.state.along.scale;
        self.matcher.park(&matcher, changes);
        self.learner
            .history
            .push(live.end.cell, self.place, scale, |way| {
                map.way(way).map_or(i32::MAX, |way| way.first_cell)
            });
        let is_on = matches!(self.place, MapMatch::On(_));
        let grade = self.grade.map(|grade| grade.grade_percent);
        self.counts = self.judge.advance(live, is_on, grade);
    }

    /// Takes a finished cell, and does a share of the work that waits: once a minute it writes to the
    /// flash memory, one erase or three writes of 256 bytes in a call.
    ///
    /// # Errors
    /// Returns the error of the flash memory. What could not be written is tried again.
    pub fn finish(&mut self, cell: &Cell) -> Result<(), MemoryError<F::Error>> {
        self.judge.finish(cell);
        let is_displaced = self.judge.alignment().is_displaced();
        self.learner.finish(&mut self.store, cell, is_displaced)
    }

    /// Ends the drive: writes what is not written yet. The vehicle stands.
    ///
    /// # Errors
    /// Returns the error of the flash memory.
    pub fn close(&mut self) -> Result<(), MemoryError<F::Error>> {
        self.learner.close(&mut self.store)
    }

    /// Moves a page from a sector that is written rarely to a worn one, if sectors are worn unevenly.
    /// For a vehicle that stands: call it at the begin of a drive until it returns false.
    ///
    /// # Errors
    /// Returns the error of the flash memory.
    pub fn level(&mut self) -> Result<bool, MemoryError<F::Error>> {
        self.learner.level(&mut self.store)
    }

    /// Returns where the vehicle is on the roads of the memory.
    #[must_use]
    pub const fn place(&self) -> MapMatch {
        self.place
    }

    /// Returns the grade of the memory where the vehicle is; `None` where there is none, and where it
    /// is left out because it differs from the estimate.
    #[must_use]
    pub fn grade(&self) -> Option<MemoryGrade> {
        self.grade.filter(|_| self.counts)
    }

    /// Returns whether the memory is left out because it differs from the estimate.
    #[must_use]
    pub const fn is_left_out(&self) -> bool {
        self.judge.is_left_out()
    }

    /// Returns what happened on the roads of the memory.
    #[must_use]
    pub const fn map_counters(&self) -> &MapCounters {
        self.judge.counters()
    }

    /// Returns what the drive gave.
    #[must_use]
    pub const fn counters(&self) -> MemoryCounters {
        self.learner.counters()
    }

    /// Returns how often each sector was erased.
    pub fn erases(&self) -> impl Iterator<Item = u32> {
        self.store.erases()
    }

    /// Returns the flash memory.
    #[must_use]
    pub const fn flash(&self) -> &F {
        self.store.flash()
    }

    /// Returns the flash memory, for its driver. What changes in it is not seen before the memory is
    /// opened again.
    #[must_use]
    pub const fn flash_mut(&mut self) -> &mut F {
        self.store.flash_mut()
    }

    /// Returns the flash memory, and gives up what is not written yet.
    #[must_use]
    pub fn into_flash(self) -> F {
        self.store.into_flash()
    }
}

/// Returns the profile at a place. It goes on from the cell before: to read a block from its begin
/// takes longer than all else.
#[inline(never)] // Its room on the stack is not that of the search.
fn profile_at<'m>(
    map: PackedMap<'m>,
    place: &MapPlace,
    parked: Option<ParkedProfile>,
) -> Option<Profile<'m>> {
    let parked = parked.filter(|parked| parked.leads_to(place.block, place.cell));
    if let Some(mut profile) = parked.and_then(|parked| Profile::resume(map, &parked))
        && profile.seek(place.cell)
    {
        return Some(profile);
    }
    // The matcher is in this block.
    Profile::again(map, place.block, place.cell)
}

fn grade_at(profile: &Profile<'_>, cell: f32, sigma_m: f32) -> Option<MemoryGrade> {
    let grade_percent = profile.grade_percent(cell, sigma_m)?;
    let (sigma, runs) = profile.own_sigma();
    let runs = runs.min(u16::MAX.into()) as u16;
    Some(MemoryGrade {
        grade_percent,
        common_variance: Parts::of(sigma * sigma, runs).common,
    })
}
