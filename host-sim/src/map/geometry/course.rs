//! Directions of vehicles and roads against each other.

/// Courses within this are the same direction, within this of the reverse the opposite one, deg.
const COURSE_TOLERANCE_DEG: f64 = 45.0;

/// How a vehicle goes on a road.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Heading {
    Along,
    /// Neither, but rather forwards than backwards.
    AcrossForward,
    AcrossBackward,
    Opposite,
}

/// Told without the angle itself, at every segment around: within 45° what is ahead is more than
/// what is beside.
pub(crate) fn heading(road: [f64; 2], course: [f64; 2]) -> Heading {
    let beside = (road[0] * course[1] - road[1] * course[0]).abs();
    let ahead = road[0] * course[0] + road[1] * course[1];
    let limit = beside / COURSE_TOLERANCE_DEG.to_radians().tan();
    if ahead >= limit {
        Heading::Along
    } else if ahead <= -limit {
        Heading::Opposite
    } else if ahead >= 0.0 {
        Heading::AcrossForward
    } else {
        Heading::AcrossBackward
    }
}
