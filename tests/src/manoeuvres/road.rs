//! The road of the bench: the measured profile of the E4, or one like it.

use crate::image::root;
use host_sim::error::{Error, Result};
use host_sim::simulator::road::{Node, Road};
use host_sim::simulator::road_file;
use host_sim::simulator::road_generator::{RoadShape, generate};

/// Length over which another profile joins that of the road, m.
const JOIN_M: f64 = 200.0;
/// Altitude that a road with another profile gains, m, so that it stays above the sea.
const RAISED_M: f64 = 300.0;
/// Length of the generated road, m: that of the measured one.
const LENGTH_M: f64 = 118_848.0;

/// A road and where it comes from.
#[derive(Clone, Debug)]
pub struct BenchRoad {
    /// The road.
    pub road: Road,
    /// True if it is the measured profile.
    pub is_measured: bool,
}

impl BenchRoad {
    /// Reads the measured profile, or generates a road with the same statistics if it is missing.
    ///
    /// # Errors
    /// Returns an error for a damaged file.
    pub fn load() -> Result<Self> {
        let path = root().join("../shared/data/e4/road.csv");
        if path.exists() {
            return Ok(Self {
                road: road_file::read(&path)?,
                is_measured: true,
            });
        }
        let shape = RoadShape {
            length_m: LENGTH_M,
            grade_sigma_percent: 1.6,
            largest_grade_percent: 3.9,
            ..RoadShape::default()
        };
        Ok(Self {
            road: generate(&shape, 4),
            is_measured: false,
        })
    }
}

/// Another profile on a stretch: grades in % at distances from its start, m, linear in between.
#[derive(Clone, Debug, PartialEq)]
pub struct Profile {
    /// Start on the road, m.
    pub from_m: f64,
    /// Distances from there, m, ascending, and grades, %.
    pub corners: Vec<(f64, f64)>,
}

impl Profile {
    /// Returns the length, m.
    #[must_use]
    pub fn length_m(&self) -> f64 {
        self.corners.last().map_or(0.0, |corner| corner.0)
    }

    /// Returns the grade that the road has here with the profile, as a tangent.
    fn grade(&self, distance_m: f64, own: f64) -> f64 {
        let at_m = distance_m - self.from_m;
        let beyond_m = (-at_m).max(at_m - self.length_m()).max(0.0);
        let part = (1.0 - beyond_m / JOIN_M).clamp(0.0, 1.0);
        part * 0.01 * self.percent(at_m) + (1.0 - part) * own
    }

    fn percent(&self, at_m: f64) -> f64 {
        let after = self.corners.partition_point(|corner| corner.0 <= at_m);
        match (
            after.checked_sub(1).and_then(|i| self.corners.get(i)),
            self.corners.get(after),
        ) {
            (Some(from), Some(to)) => from.1 + (to.1 - from.1) * (at_m - from.0) / (to.0 - from.0),
            (Some(end), None) | (None, Some(end)) => end.1,
            (None, None) => 0.0,
        }
    }
}

/// Returns the road with other profiles on some stretches.
///
/// # Errors
/// Never: the nodes are those of a road.
pub fn with_profiles(road: &Road, profiles: &[Profile]) -> Result<Road> {
    if profiles.is_empty() {
        return Ok(road.clone());
    }
    let start_m = road.altitude_m(0.0) + RAISED_M;
    let nodes = road.nodes().map(|(node, _)| Node {
        grade: profiles.iter().fold(node.grade, |grade, profile| {
            profile.grade(node.distance_m, grade)
        }),
        ..node
    });
    Road::new(nodes.collect(), start_m)
        .ok_or_else(|| Error::content(&root(), "a profile without nodes"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_profile_replaces_the_grade_and_joins_over_200_m() {
        let road = generate(&RoadShape::default(), 1);
        let profile = Profile {
            from_m: 5_000.0,
            corners: vec![(0.0, -6.0), (1_000.0, -6.0)],
        };
        let edited = with_profiles(&road, std::slice::from_ref(&profile)).unwrap();
        assert!((edited.grade(5_500.0) + 0.06).abs() < 1e-9);
        assert!((edited.grade(4_700.0) - road.grade(4_700.0)).abs() < 1e-12);
        assert!((edited.grade(6_300.0) - road.grade(6_300.0)).abs() < 1e-12);
        let fall_m = edited.altitude_m(6_000.0) - edited.altitude_m(5_000.0);
        assert!((fall_m + 59.9).abs() < 0.2, "{fall_m}");
    }
}
