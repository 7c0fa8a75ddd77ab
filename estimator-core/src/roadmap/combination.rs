//! The mean of two estimates of a grade.

use super::memory::MemoryGrade;
use crate::cell::Uncertain;
use libm::sqrtf;

/// The live grade with what is known of the road.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RoadGrade {
    /// The live grade combined with that of the road, %.
    pub combined_percent: Uncertain,
    /// Grade of the road, %: of a map, of the memory, or of both.
    pub road_percent: Uncertain,
}

/// Returns a live grade combined with that of a map and that of the vehicle's own memory, as far as
/// they count; `None` if neither does. The map is made of other drives. Live grade and memory are of
/// one vehicle: a part of their errors is the same.
#[must_use]
pub fn combined_with_roads(
    live_percent: Uncertain,
    map_percent: Option<Uncertain>,
    memory: Option<MemoryGrade>,
) -> Option<RoadGrade> {
    let Some(memory) = memory else {
        return map_percent.map(|map| RoadGrade {
            combined_percent: combined(live_percent, map),
            road_percent: map,
        });
    };
    let own = combined_dependent(live_percent, memory.grade_percent, memory.common_variance);
    let with_map = |grade| map_percent.map_or(grade, |map| combined(grade, map));
    Some(RoadGrade {
        combined_percent: with_map(own),
        road_percent: with_map(memory.grade_percent),
    })
}

/// Returns the mean of two independent estimates, weighted by the inverse of their variances.
pub(super) fn combined(a: Uncertain, b: Uncertain) -> Uncertain {
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

/// Returns the mean of two estimates whose errors have this covariance, with the weights that make its
/// variance least. None is below zero.
pub(super) fn combined_dependent(a: Uncertain, b: Uncertain, covariance: f32) -> Uncertain {
    let (a_variance, b_variance) = (a.sigma * a.sigma, b.sigma * b.sigma);
    let sum = a_variance + b_variance - 2.0 * covariance;
    if sum <= 0.0 {
        return if a_variance <= b_variance { a } else { b };
    }
    let weight = ((b_variance - covariance) / sum).clamp(0.0, 1.0);
    let rest = 1.0 - weight;
    let variance =
        weight * weight * a_variance + rest * rest * b_variance + 2.0 * weight * rest * covariance;
    Uncertain {
        value: weight * a.value + rest * b.value,
        sigma: sqrtf(variance),
    }
}
