//! Courses of vehicles relative to roads.

/// Tolerance of the same direction and of the opposite direction, deg.
const COURSE_TOLERANCE_DEG: f64 = 45.0;

/// Course of a vehicle relative to a road.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum CourseRelation {
    Along,
    /// Across, more forwards than backwards.
    AcrossForward,
    AcrossBackward,
    Opposite,
}

/// Compares two directions without computing the angle. The angle is below 45° if the component
/// along the road exceeds the lateral one.
pub(crate) fn heading(road: [f64; 2], course: [f64; 2]) -> CourseRelation {
    let beside = (road[0] * course[1] - road[1] * course[0]).abs();
    let ahead = road[0] * course[0] + road[1] * course[1];
    let limit = beside / COURSE_TOLERANCE_DEG.to_radians().tan();
    if ahead >= limit {
        CourseRelation::Along
    } else if ahead <= -limit {
        CourseRelation::Opposite
    } else if ahead >= 0.0 {
        CourseRelation::AcrossForward
    } else {
        CourseRelation::AcrossBackward
    }
}
