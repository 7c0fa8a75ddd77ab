//! The road ahead by the map, for the live view.

use estimator_core::Uncertain;
use estimator_core::roadmap::{Horizon, MapCounters, MapLive, MapMatch};
use serde::Serialize;

/// Length of the road that is shown, m.
pub const LENGTH_M: f32 = 2_000.0;
/// Distance between two points of it, m.
pub const STEP_M: f32 = 25.0;

/// What the vehicle knows from its map.
#[derive(Clone, Debug)]
pub struct RoadView {
    /// Whether the place is known.
    pub state: RoadState,
    /// Grade of the map under the wheels, %.
    pub map_percent: Option<Uncertain>,
    /// Live grade without the map, %.
    pub own_percent: Option<Uncertain>,
    /// Grades of the most probable path, %, every [`STEP_M`].
    pub ahead_percent: Vec<Option<Uncertain>>,
    /// What leaves this path.
    pub forks: Vec<Fork>,
    /// What happened on the map.
    pub counters: MapCounters,
}

/// What is known of the place.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum RoadState {
    /// On the map.
    On,
    /// On the map, which does not fit the estimate and does not count.
    LeftOut,
    /// Perhaps on the map.
    Unclear,
    /// Not on the map.
    Off,
}

/// A way that leaves the most probable path.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Fork {
    /// Distance from the vehicle, m.
    pub from_m: f32,
    /// Probability that the vehicle takes it.
    pub probability: f32,
}

impl RoadView {
    /// Returns what there is to see. `own_percent` is the live grade without the map.
    #[must_use]
    pub fn of(map: &MapLive<'_>, own_percent: Option<Uncertain>) -> Self {
        let state = match map.matcher().place() {
            MapMatch::On(_) if map.is_left_out() => RoadState::LeftOut,
            MapMatch::On(_) => RoadState::On,
            MapMatch::Unclear => RoadState::Unclear,
            MapMatch::Off => RoadState::Off,
        };
        let horizon = map
            .trusted_place()
            .and_then(|place| Horizon::new(*map.matcher().map(), &place, LENGTH_M).ok());
        let branches = horizon.as_ref().map_or(&[][..], Horizon::branches);
        let ahead = horizon.iter().flat_map(|horizon| {
            let first = horizon.branches().iter().take(1);
            first.flat_map(|branch| horizon.points(branch, STEP_M))
        });
        Self {
            state,
            map_percent: map.map_grade_percent(),
            own_percent,
            ahead_percent: ahead.map(|point| point.grade_percent).collect(),
            forks: branches
                .iter()
                .skip(1)
                .map(|branch| Fork {
                    from_m: branch.from_m,
                    probability: branch.probability,
                })
                .collect(),
            counters: *map.counters(),
        }
    }
}

impl RoadState {
    /// Returns the word of the lines.
    #[must_use]
    pub const fn word(self) -> &'static str {
        match self {
            Self::On => "on",
            Self::LeftOut => "left-out",
            Self::Unclear => "unclear",
            Self::Off => "off",
        }
    }
}
