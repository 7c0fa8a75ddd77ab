//! The grade ahead in small parts, for a bus: each takes bounded work.

use super::horizon::{GradeReader, Horizon};
use super::map_live::MapLive;
use super::matcher::MapPlace;
use crate::cell::{CELL_LENGTH_M, Live, Uncertain};

/// Length of the horizon, m: 2 km are left when it is renewed.
pub const PART_LENGTH_M: f32 = 2_200.0;
/// Distance from one grade to the next, m.
pub const PART_STEP_M: f32 = 25.0;
/// Grades in a part.
pub const PART_GRADES: usize = 2;
/// Cells from the beginning of one horizon to that of the next on the same way: 200 m.
const RENEWED_CELLS: u32 = 80;
/// A grade that differs by this from that under the wheels is the next one, %: four steps of PCC1.
const NEXT_DIFFERS_PERCENT: f32 = 0.5;
/// Parts in 100 ms: a horizon of one branch takes a second, and 7 % of a bus of 250 kbit/s.
const DUE_PARTS: usize = 5;
/// Steps of work in 100 ms that may give no part.
const DUE_STEPS: usize = 20;
/// Horizons are numbered from 0 to this.
const LAST_SEQUENCE: u8 = 14;

/// A part of a horizon.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum HorizonPart {
    /// The place on the map is not known, or the map is left out: earlier parts no longer hold.
    Unknown,
    /// A branch begins. Its grades follow; those that do not follow are not known.
    Branch {
        /// Its number; 0 is the most probable path.
        branch: u8,
        /// Distance from the vehicle at which it leaves branch 0, m.
        from_m: f32,
        /// Length of the horizon, m.
        to_m: f32,
        /// Probability that the vehicle takes it.
        probability: f32,
    },
    /// Grades of the branch that began last.
    Grades {
        /// Its number.
        branch: u8,
        /// Distance of the first grade from the vehicle, m. The others follow every [`PART_STEP_M`].
        ahead_m: f32,
        /// Grades, %; `None` where the map has none.
        grades_percent: [Option<Uncertain>; PART_GRADES],
    },
}

/// A part, and the horizon that it belongs to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NumberedPart {
    /// Number of the horizon, 0 to 14, in turns.
    pub sequence: u8,
    /// Cell at the end of which the vehicle was: distances count from there.
    pub cell: u32,
    /// The part.
    pub part: HorizonPart,
}

/// The next grade of the road, in the sense of PCC1: the first one ahead that differs from that under
/// the wheels by 0.5 %, or the last one known where none does.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NextGrade {
    /// Distance from the vehicle, m.
    pub ahead_m: f32,
    /// Grade there, %.
    pub grade_percent: f32,
}

/// A horizon whose parts are handed out.
#[derive(Clone, Debug)]
struct Begun<'m> {
    horizon: Horizon<'m>,
    /// Whether all paths are followed.
    is_whole: bool,
    branch: usize,
    /// Reader of the branch, once it has begun.
    reader: Option<GradeReader<'m>>,
    /// Grade of the map under the wheels, %.
    present_percent: Option<f32>,
    next: Option<NextGrade>,
    /// Whether the next grade is final.
    is_next_found: bool,
}

/// Divides the road ahead into parts, one horizon after the other.
#[derive(Clone, Debug, Default)]
pub struct HorizonParts<'m> {
    begun: Option<Begun<'m>>,
    sequence: u8,
    /// Where the horizon began, if one did since the place is known, and on which way.
    cell: Option<u32>,
    way: u32,
    /// The next grade, with its distance from the end of a cell.
    next: Option<(u32, NextGrade)>,
}

impl<'m> HorizonParts<'m> {
    /// Creates it before the first horizon.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// Does a bounded part of the work at the live estimate. Returns a part; `None` if there is
    /// none yet: then the next call goes on.
    pub fn next_part(&mut self, map: &MapLive<'m>, live: &Live) -> Option<NumberedPart> {
        let Some(place) = map.trusted_place() else {
            self.begun = None;
            self.next = None;
            let cell = self.cell.take()?;
            return Some(self.numbered(cell, HorizonPart::Unknown));
        };
        let Some(begun) = &mut self.begun else {
            self.begin(map, &place, live.end.cell);
            return None;
        };
        if !begun.is_whole {
            match begun.horizon.extend() {
                Ok(more) => begun.is_whole = !more,
                Err(_) => self.begun = None,
            }
            return None;
        }
        let cell = self.cell?;
        let part = begun.next_part();
        if begun.is_next_found {
            self.next = begun.next.map(|next| (cell, next));
        }
        if begun.branch >= begun.horizon.branches().len() {
            self.begun = None;
        }
        Some(self.numbered(cell, part?))
    }

    /// Returns the parts that are due in 100 ms, at most five. Each takes bounded work.
    pub fn due_parts<'a>(
        &'a mut self,
        map: &'a MapLive<'m>,
        live: &'a Live,
    ) -> impl Iterator<Item = NumberedPart> + 'a {
        let parts = (0..DUE_STEPS).filter_map(|_| self.next_part(map, live));
        parts.take(DUE_PARTS)
    }

    /// Returns the next grade, seen from the live estimate.
    #[must_use]
    pub fn next_grade(&self, live: &Live) -> Option<NextGrade> {
        let (cell, next) = self.next?;
        let driven_m = live.end.cell.checked_sub(cell)? as f32 * CELL_LENGTH_M;
        let ahead_m = next.ahead_m - driven_m;
        (ahead_m >= 0.0).then_some(NextGrade { ahead_m, ..next })
    }

    fn begin(&mut self, map: &MapLive<'m>, place: &MapPlace, cell: u32) {
        let is_due = |begun: u32| {
            // The cells of the next drive are numbered from the start.
            place.way != self.way || cell < begun || cell - begun >= RENEWED_CELLS
        };
        if !self.cell.is_none_or(is_due) {
            return;
        }
        self.sequence = if self.sequence >= LAST_SEQUENCE {
            0
        } else {
            self.sequence + 1
        };
        self.cell = Some(cell);
        self.way = place.way;
        self.begun = Some(Begun {
            horizon: Horizon::begin(*map.matcher().map(), place, PART_LENGTH_M),
            is_whole: false,
            branch: 0,
            reader: None,
            present_percent: None,
            next: None,
            is_next_found: false,
        });
    }

    fn numbered(&self, cell: u32, part: HorizonPart) -> NumberedPart {
        NumberedPart {
            sequence: self.sequence,
            cell,
            part,
        }
    }
}

impl Begun<'_> {
    fn next_part(&mut self) -> Option<HorizonPart> {
        let branch = self.horizon.branches().get(self.branch)?;
        let number = self.branch as u8;
        let Some(reader) = &mut self.reader else {
            self.reader = Some(self.horizon.reader(branch, PART_STEP_M));
            return Some(HorizonPart::Branch {
                branch: number,
                from_m: branch.from_m,
                to_m: self.horizon.length_m(),
                probability: branch.probability,
            });
        };
        let Some(first) = self.horizon.next_point(branch, reader) else {
            self.reader = None;
            self.is_next_found = true;
            self.branch += 1;
            return None;
        };
        let mut grades_percent = [first.grade_percent; PART_GRADES];
        for grade_percent in grades_percent.iter_mut().skip(1) {
            let point = self.horizon.next_point(branch, reader);
            *grade_percent = point.and_then(|point| point.grade_percent);
        }
        if self.branch == 0 {
            self.look_for_next(first.ahead_m, &grades_percent);
        }
        let is_known = grades_percent.iter().any(Option::is_some);
        is_known.then_some(HorizonPart::Grades {
            branch: number,
            ahead_m: first.ahead_m,
            grades_percent,
        })
    }

    fn look_for_next(&mut self, from_m: f32, grades_percent: &[Option<Uncertain>]) {
        for (index, grade) in grades_percent.iter().enumerate() {
            let Some(Uncertain { value, .. }) = *grade else {
                continue;
            };
            if self.is_next_found {
                return;
            }
            let present = *self.present_percent.get_or_insert(value);
            self.next = Some(NextGrade {
                ahead_m: from_m + index as f32 * PART_STEP_M,
                grade_percent: value,
            });
            self.is_next_found = (value - present).abs() >= NEXT_DIFFERS_PERCENT;
        }
    }
}
