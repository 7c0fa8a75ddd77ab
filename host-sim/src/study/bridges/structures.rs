//! Structures on a road, and the ground under or above them.

use crate::simulator::road::Road;
use std::f64::consts::PI;
use std::ops::Range;

/// Routers cut slopes of terrain off at this, %.
pub(super) const CLAMP_PERCENT: f64 = 3.0;
/// Distance of the posts of the terrain model, m: 1 arc second.
const POST_M: f64 = 30.0;

/// A kind of structure.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    Bridge,
    Cutting,
    Tunnel,
}

impl Kind {
    pub(super) const fn word(self) -> &'static str {
        match self {
            Self::Bridge => "bridge",
            Self::Cutting => "cutting",
            Self::Tunnel => "tunnel",
        }
    }
}

/// A structure.
#[derive(Clone, Copy, Debug)]
pub(super) struct Structure {
    pub(super) kind: Kind,
    pub(super) from_m: f64,
    pub(super) length_m: f64,
    /// Height of the ground over the road in the middle, m.
    pub(super) ground_m: f64,
}

/// The structures of each road. Valleys under bridges have sides of up to 45 %.
pub(super) const STRUCTURES: [Structure; 8] = [
    of(Kind::Bridge, 3_000.0, 250.0, -18.0),
    of(Kind::Bridge, 5_000.0, 400.0, -30.0),
    of(Kind::Bridge, 7_000.0, 600.0, -45.0),
    of(Kind::Bridge, 9_000.0, 800.0, -60.0),
    of(Kind::Cutting, 11_500.0, 400.0, 10.0),
    of(Kind::Cutting, 13_500.0, 800.0, 20.0),
    of(Kind::Tunnel, 16_000.0, 500.0, 60.0),
    of(Kind::Tunnel, 19_000.0, 2_000.0, 150.0),
];
/// Length of the road, m.
pub(super) const LENGTH_M: f64 = 24_000.0;

const fn of(kind: Kind, from_m: f64, length_m: f64, ground_m: f64) -> Structure {
    Structure {
        kind,
        from_m,
        length_m,
        ground_m,
    }
}

impl Structure {
    pub(super) fn name(&self) -> String {
        format!("{} of {:.0} m", self.kind.word(), self.ground_m.abs())
    }

    pub(super) fn range_m(&self) -> Range<f64> {
        self.from_m..self.from_m + self.length_m
    }

    /// Returns the height of its ground over the road, m: none at its ends.
    fn ground_at(&self, at_m: f64) -> f64 {
        let part = (at_m - self.from_m) / self.length_m;
        if (0.0..1.0).contains(&part) {
            self.ground_m * (PI * part).sin().powi(2)
        } else {
            0.0
        }
    }
}

/// Returns the highest bridge.
pub(super) fn highest_bridge() -> Structure {
    STRUCTURES[3]
}

/// Returns the longest tunnel and its number.
pub(super) fn longest_tunnel() -> (usize, Structure) {
    let last = STRUCTURES.len() - 1;
    (last, STRUCTURES[last])
}

/// Returns the parts of the road without GNSS, m.
pub(super) fn outages_m() -> impl Iterator<Item = Range<f64>> {
    STRUCTURES
        .iter()
        .filter(|structure| structure.kind == Kind::Tunnel)
        .map(Structure::range_m)
}

/// Returns the posts of a terrain model along a road: distance and altitude in whole metres.
pub(super) fn posts(road: &Road) -> Vec<(f64, f64)> {
    let count = (LENGTH_M / POST_M) as usize;
    (0..=count)
        .map(|number| {
            let at_m = number as f64 * POST_M;
            let ground_m: f64 = STRUCTURES.iter().map(|s| s.ground_at(at_m)).sum();
            (at_m, (road.altitude_m(at_m) + ground_m).round())
        })
        .collect()
}
