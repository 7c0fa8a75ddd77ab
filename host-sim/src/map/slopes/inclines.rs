//! Proposals of the tag `incline` of OpenStreetMap, for a person to review.
//!
//! The wiki (<https://wiki.openstreetmap.org/wiki/Key:incline>) asks for the way to be split at the
//! ends of the steep section, and for the practical maximum of the section, positive uphill along
//! the way.

use super::profile::{Stretch, WayProfile};
use crate::map::geometry::structure::Structure;
use std::ops::Range;

/// Length of the parts that are compared, m.
const PART_M: f64 = 25.0;
/// Range of the grades of the parts of one section, %. Values are whole percents.
const SPREAD_PERCENT: f64 = 1.5;
/// Shortest section, m. What is shorter is the curve between two sections.
const SHORTEST_M: f64 = 100.0;
/// Least incline that is worth a tag, %.
const LEAST_PERCENT: f64 = 2.0;

/// A section of a way with an incline.
#[derive(Clone, Debug, PartialEq)]
pub struct Incline<'n> {
    /// Name of the way.
    pub way: Option<&'n str>,
    /// Distances along the way, m.
    pub range_m: Range<f64>,
    /// Length of the way, m.
    pub way_length_m: f64,
    /// Latitude and longitude of its positions, deg, along the way.
    pub positions: Vec<(f64, f64)>,
    /// What carries it.
    pub structure: Option<Structure>,
    /// The value of the tag, %: its steepest part, a whole number.
    pub incline_percent: i32,
    /// The steepest part, %.
    pub steepest_percent: f64,
    /// Mean grade, %.
    pub mean_percent: f64,
    /// Largest sigma of its parts, %.
    pub sigma_percent: f64,
    /// Least number of runs.
    pub runs: u32,
}

/// Returns the sections of a way in which every part has at most this sigma, %.
#[must_use]
pub fn inclines<'n>(profile: &WayProfile<'n>, sigma_limit_percent: f64) -> Vec<Incline<'n>> {
    let count = (profile.length_m() / PART_M).round().max(1.0);
    let edge_m = |i: usize| profile.length_m() * i as f64 / count;
    let mut found = Vec::new();
    let mut section = Section::default();
    for i in 0..count as usize {
        let sure = profile
            .mean(&(edge_m(i)..edge_m(i + 1)))
            .filter(|part| part.sigma_percent <= sigma_limit_percent);
        if !sure.is_some_and(|part| section.accepts(&part)) {
            found.extend(section.incline(profile, edge_m));
            section = Section::from(i);
        }
        match sure {
            Some(part) => section.parts.push(part),
            None => section = Section::from(i + 1),
        }
    }
    found.extend(section.incline(profile, edge_m));
    found
}

/// Neighbouring parts of a similar grade.
#[derive(Default)]
struct Section {
    first: usize,
    parts: Vec<Stretch>,
}

impl From<usize> for Section {
    fn from(first: usize) -> Self {
        Self {
            first,
            parts: Vec::new(),
        }
    }
}

impl Section {
    fn accepts(&self, part: &Stretch) -> bool {
        let grades = self.parts.iter().chain([part]).map(|p| p.grade_percent);
        let (least, most) = grades.fold((f64::MAX, f64::MIN), |(least, most), grade| {
            (least.min(grade), most.max(grade))
        });
        most - least <= SPREAD_PERCENT
    }

    /// Returns the incline of the section, if it is long and steep enough.
    fn incline<'n>(
        &self,
        profile: &WayProfile<'n>,
        edge_m: impl Fn(usize) -> f64,
    ) -> Option<Incline<'n>> {
        let range_m = edge_m(self.first)..edge_m(self.first + self.parts.len());
        let grades = || self.parts.iter().map(|part| part.grade_percent);
        let steepest_percent = grades().max_by(|a, b| a.abs().total_cmp(&b.abs()))?;
        if range_m.end - range_m.start < SHORTEST_M || steepest_percent.abs() < LEAST_PERCENT {
            return None;
        }
        Some(Incline {
            way: profile.way,
            positions: profile.positions(&range_m),
            range_m,
            way_length_m: profile.length_m(),
            structure: profile.structure,
            incline_percent: steepest_percent.round() as i32,
            steepest_percent,
            mean_percent: grades().sum::<f64>() / self.parts.len() as f64,
            sigma_percent: self
                .parts
                .iter()
                .map(|p| p.sigma_percent)
                .fold(0.0, f64::max),
            runs: self.parts.iter().map(|part| part.runs).min()?,
        })
    }
}
