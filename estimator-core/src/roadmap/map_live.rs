//! The live grade with the map.

use super::combination::combined;
use super::map_judge::{MapCounters, MapJudge};
use super::map_limits::MapLimits;
use super::matcher::{MapMatch, MapPlace, Matcher};
use super::packed_map::PackedMap;
use super::profile::Profile;
use crate::cell::{Cell, Live, Uncertain};

/// The live grade combined with that of a map.
///
/// It stands beside the estimator: lagged and smoothed grades never contain a map. Errors of
/// estimate and map are independent, because the map is made of other drives; both count by their
/// variance. A map that differs from the estimate by more than both sigmas explain is left out until
/// it fits again.
#[derive(Clone, Debug)]
pub struct MapLive<'m> {
    matcher: Matcher<'m>,
    profile: Option<Profile<'m>>,
    judge: MapJudge,
    map_grade_percent: Option<Uncertain>,
    combined_percent: Option<Uncertain>,
}

impl<'m> MapLive<'m> {
    /// Creates it for a map, before the first cell.
    #[must_use]
    pub fn new(map: PackedMap<'m>) -> Self {
        Self {
            matcher: Matcher::new(map),
            profile: None,
            judge: MapJudge::new(MapLimits::MAP),
            map_grade_percent: None,
            combined_percent: None,
        }
    }

    /// Moves on to the live estimate at the end of a cell.
    pub fn advance(&mut self, live: &Live) {
        if self.matcher.state.is_next_drive(&live.end) {
            self.matcher.forget();
            self.profile = None;
            self.judge.begin_drive();
        }
        self.matcher.advance(&live.end);
        let place = self.matcher.place();
        let map = match &place {
            MapMatch::On(place) => self.grade_at(place),
            _ => None,
        };
        let is_on_map = matches!(place, MapMatch::On(_));
        let counts = self.judge.advance(live, is_on_map, map);
        let own = live.estimate.grade_percent;
        self.map_grade_percent = map;
        self.combined_percent = map.filter(|_| counts).map(|map| combined(own, map));
    }

    /// Compares a finished cell with the map: its lagged grade shows whether the map is shifted along
    /// the road.
    pub fn finish(&mut self, cell: &Cell) {
        self.judge.finish(cell);
    }

    /// Returns how far the vehicle is ahead of its place on the map, m, as the grades tell.
    #[must_use]
    pub fn shift_m(&self) -> Uncertain {
        self.judge.alignment().shift_m()
    }

    /// Returns the live grade combined with the map's, %; `None` where there is no map, its place is
    /// not known, or it is left out.
    #[must_use]
    pub const fn combined_percent(&self) -> Option<Uncertain> {
        self.combined_percent
    }

    /// Returns the live estimate with the combined grade in place of its own, where there is one.
    #[must_use]
    pub fn applied(&self, live: &Live) -> Live {
        let mut live = *live;
        if let Some(combined) = self.combined_percent {
            live.estimate.grade_percent = combined;
        }
        live
    }

    /// Returns the place on the map; `None` where it is not known or the map is left out.
    #[must_use]
    pub fn trusted_place(&self) -> Option<MapPlace> {
        match self.matcher.place() {
            MapMatch::On(place) if !self.is_left_out() => Some(MapPlace {
                sigma_m: self.judge.alignment().with_shift(place.sigma_m),
                ..place
            }),
            _ => None,
        }
    }

    /// Returns the grade of the map where the vehicle is, %, with the error of the place.
    #[must_use]
    pub const fn map_grade_percent(&self) -> Option<Uncertain> {
        self.map_grade_percent
    }

    /// Returns the grade of the map where the vehicle is, %, if it counts.
    #[must_use]
    pub const fn counted_percent(&self) -> Option<Uncertain> {
        match self.combined_percent {
            Some(_) => self.map_grade_percent,
            None => None,
        }
    }

    /// Returns whether the map is left out because it differs from the estimate.
    #[must_use]
    pub const fn is_left_out(&self) -> bool {
        self.judge.is_left_out()
    }

    /// Returns what knows the place.
    #[must_use]
    pub const fn matcher(&self) -> &Matcher<'m> {
        &self.matcher
    }

    /// Returns what happened.
    #[must_use]
    pub const fn counters(&self) -> &MapCounters {
        self.judge.counters()
    }

    fn grade_at(&mut self, place: &MapPlace) -> Option<Uncertain> {
        let follows =
            |profile: &Profile<'m>| profile.way() == place.way && profile.is_before(place.cell);
        if !self.profile.as_ref().is_some_and(follows) {
            self.profile = Profile::new(*self.matcher.map(), place.block, place.cell);
        }
        let profile = self.profile.as_mut()?;
        if !profile.seek(place.cell) {
            // It does not pass a damaged block. The next one begins in the block of its place.
            self.profile = None;
            return None;
        }
        let sigma_m = self.judge.alignment().with_shift(place.sigma_m);
        profile.grade_percent(place.cell, sigma_m)
    }
}
