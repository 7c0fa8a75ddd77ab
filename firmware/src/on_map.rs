//! The map beside the estimator: what every board does with it after a step and after a cell.

use estimator_core::broadcast;
use estimator_core::roadmap::{HorizonParts, MapLive, NextGrade, NumberedPart, PackedMap};
use estimator_core::{Cell, Live};

/// The live grade with a map, and the road ahead.
#[derive(Clone, Debug)]
pub struct OnMap<'m> {
    map: MapLive<'m>,
    parts: HorizonParts<'m>,
}

impl<'m> OnMap<'m> {
    /// Creates it for a map, before the first step.
    #[must_use]
    pub fn new(map: PackedMap<'m>) -> Self {
        Self {
            map: MapLive::new(map),
            parts: HorizonParts::new(),
        }
    }

    /// Moves on after a step that moved the filter.
    pub fn advance(&mut self, live: &Live) {
        self.map.advance(live);
    }

    /// Compares a finished cell with the map.
    pub fn finish(&mut self, cell: &Cell) {
        self.map.finish(cell);
    }

    /// Returns the place and the grade with the map.
    #[must_use]
    pub const fn map(&self) -> &MapLive<'m> {
        &self.map
    }

    /// Does a bounded part of the work for the road ahead.
    pub fn next_part(&mut self, live: &Live) -> Option<NumberedPart> {
        self.parts.next_part(&self.map, live)
    }

    /// Returns the next grade of the road.
    #[must_use]
    pub fn next_grade(&self, live: &Live) -> Option<NextGrade> {
        self.parts.next_grade(live)
    }

    /// Returns the frames of the road ahead that are due in 100 ms. Each takes bounded work.
    pub fn ahead_frames<'a, F: embedded_can::Frame>(
        &'a mut self,
        live: &'a Live,
        source: u8,
    ) -> impl Iterator<Item = F> + use<'a, 'm, F> {
        let parts = self.parts.due_parts(&self.map, live);
        parts.filter_map(move |part| broadcast::ahead(&part, source))
    }

    /// Returns PCC1: the live grade, which the caller has combined with the map
    /// ([`MapLive::applied`]), and the next one.
    #[must_use]
    pub fn pcc1<F: embedded_can::Frame>(&self, live: &Live, source: u8) -> Option<F> {
        let grade = live.estimate.grade_percent.value;
        broadcast::pcc1(Some(grade), self.next_grade(live), source)
    }
}
