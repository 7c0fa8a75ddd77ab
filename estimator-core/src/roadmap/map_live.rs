//! The live grade with the map.

use super::alignment::Alignment;
use super::matcher::{MapMatch, MapPlace, Matcher};
use super::packed_map::PackedMap;
use super::profile::Profile;
use crate::cell::{CELL_LENGTH_M, Cell, Live, Uncertain};
use libm::sqrtf;

/// Distance over which the map is compared with the estimate, m.
const COMPARED_M: f32 = 150.0;
/// Mean normalised squared difference from which the map is left out, and below which it counts
/// again: 2.4 standard deviations over the whole distance, and 1.4.
const LEFT_OUT: f32 = 6.0;
const COUNTS_AGAIN: f32 = 2.0;

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
    /// Mean squared difference of estimate and map, in their standard deviations.
    difference: f32,
    is_left_out: bool,
    alignment: Alignment,
    /// Standard deviation of the map's grade, %, lately.
    map_sigma_percent: f32,
    map_grade_percent: Option<Uncertain>,
    combined_percent: Option<Uncertain>,
    counters: MapCounters,
}

/// What happened on the map.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct MapCounters {
    /// Cells with a known place on the map.
    pub cells_on_map: u32,
    /// Cells in which the map was left out because it differs from the estimate.
    pub cells_left_out: u32,
    /// Times that the map was left out.
    pub times_left_out: u32,
}

impl<'m> MapLive<'m> {
    /// Creates it for a map, before the first cell.
    #[must_use]
    pub fn new(map: PackedMap<'m>) -> Self {
        Self {
            matcher: Matcher::new(map),
            profile: None,
            difference: 1.0,
            is_left_out: false,
            alignment: Alignment::new(),
            map_sigma_percent: 0.0,
            map_grade_percent: None,
            combined_percent: None,
            counters: MapCounters::default(),
        }
    }

    /// Moves on to the live estimate at the end of a cell.
    pub fn advance(&mut self, live: &Live) {
        self.matcher.advance(&live.end);
        self.map_grade_percent = None;
        self.combined_percent = None;
        let cell = live.end.cell;
        let MapMatch::On(place) = self.matcher.place() else {
            self.alignment.hold(cell, None);
            return;
        };
        self.counters.cells_on_map = self.counters.cells_on_map.saturating_add(1);
        let map = self.grade_at(&place);
        self.alignment.hold(cell, map.map(|map| map.value));
        let Some(map) = map else {
            return;
        };
        self.map_grade_percent = Some(map);
        self.map_sigma_percent = map.sigma;
        let own = live.estimate.grade_percent;
        self.compare(own, map);
        if self.is_left_out() {
            self.counters.cells_left_out = self.counters.cells_left_out.saturating_add(1);
        } else {
            self.combined_percent = Some(combined(own, map));
        }
    }

    /// Compares a finished cell with the map: its lagged grade shows whether the map is shifted along
    /// the road.
    pub fn finish(&mut self, cell: &Cell) {
        let was_left_out = self.is_left_out();
        self.alignment.compare(cell, self.map_sigma_percent);
        self.count_left_out(was_left_out);
    }

    /// Returns how far the vehicle is ahead of its place on the map, m, as the grades tell.
    #[must_use]
    pub fn shift_m(&self) -> Uncertain {
        self.alignment.shift_m()
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
            MapMatch::On(place) if !self.is_left_out() => Some(place),
            _ => None,
        }
    }

    /// Returns the grade of the map where the vehicle is, %, with the error of the place.
    #[must_use]
    pub const fn map_grade_percent(&self) -> Option<Uncertain> {
        self.map_grade_percent
    }

    /// Returns whether the map is left out because it differs from the estimate.
    #[must_use]
    pub const fn is_left_out(&self) -> bool {
        self.is_left_out || self.alignment.is_displaced()
    }

    /// Returns what knows the place.
    #[must_use]
    pub const fn matcher(&self) -> &Matcher<'m> {
        &self.matcher
    }

    /// Returns what happened.
    #[must_use]
    pub const fn counters(&self) -> &MapCounters {
        &self.counters
    }

    fn grade_at(&mut self, place: &MapPlace) -> Option<Uncertain> {
        let follows =
            |profile: &Profile<'m>| profile.way() == place.way && profile.is_before(place.cell);
        if !self.profile.as_ref().is_some_and(follows) {
            self.profile = Profile::new(*self.matcher.map(), place.block, place.cell);
        }
        let profile = self.profile.as_mut()?;
        profile
            .seek(place.cell)
            .then(|| profile.grade_percent(place.cell, place.sigma_m))
            .flatten()
    }

    fn compare(&mut self, own: Uncertain, map: Uncertain) {
        let difference = own.value - map.value;
        let variance = own.sigma * own.sigma + map.sigma * map.sigma;
        if variance <= 0.0 || !difference.is_finite() {
            return;
        }
        let was_left_out = self.is_left_out();
        let squared = (difference * difference / variance).min(100.0);
        self.difference += (squared - self.difference) * CELL_LENGTH_M / COMPARED_M;
        if self.difference > LEFT_OUT {
            self.is_left_out = true;
        } else if self.difference < COUNTS_AGAIN {
            self.is_left_out = false;
        }
        self.count_left_out(was_left_out);
    }

    fn count_left_out(&mut self, was_left_out: bool) {
        if self.is_left_out() && !was_left_out {
            self.counters.times_left_out = self.counters.times_left_out.saturating_add(1);
        }
    }
}

/// Returns the mean of two independent estimates, weighted by the inverse of their variances.
fn combined(a: Uncertain, b: Uncertain) -> Uncertain {
    let (a_variance, b_variance) = (a.sigma * a.sigma, b.sigma * b.sigma);
    let sum = a_variance + b_variance;
    if sum <= 0.0 {
        return a;
    }
    Uncertain {
        value: (a.value * b_variance + b.value * a_variance) / sum,
        sigma: sqrtf(a_variance * b_variance / sum),
    }
}
