//! Courses of vehicles relative to roads.

/// Tangent of the tolerance of the same direction and of the opposite direction: 45°.
const TOLERANCE_TANGENT: f64 = 1.0;

/// Course of a vehicle relative to a road.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum CourseRelation {
    Along,
    /// Across, more forwards than backwards.
    AcrossForward,
    AcrossBackward,
    Opposite,
}

/// Compares two directions without computing the angle. The angle is within the tolerance if the
/// lateral component is at most its tangent times the one along the road.
pub(crate) fn heading(road: [f64; 2], course: [f64; 2]) -> CourseRelation {
    let beside = (road[0] * course[1] - road[1] * course[0]).abs();
    let ahead = road[0] * course[0] + road[1] * course[1];
    let reach = TOLERANCE_TANGENT * ahead;
    if reach >= beside {
        CourseRelation::Along
    } else if -reach >= beside {
        CourseRelation::Opposite
    } else if ahead >= 0.0 {
        CourseRelation::AcrossForward
    } else {
        CourseRelation::AcrossBackward
    }
}
