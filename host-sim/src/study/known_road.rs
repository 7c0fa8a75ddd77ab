//! A road of the simulator as a map has it, with its truth.

use crate::map::{MapRow, Network, RoadLine, RoadPoint, RoadProblem};
use crate::score::{ScoreRow, Unscorable, score_map};
use crate::simulator::road::{Node, Road};

/// A single road with its true grade.
#[derive(Debug)]
pub struct KnownRoad {
    /// The road.
    pub network: Network,
    /// Distance, m, and true grade, %.
    pub truth: Vec<(f64, f64)>,
}

impl KnownRoad {
    /// Creates the road through the nodes of a simulated one.
    ///
    /// # Errors
    /// Returns an error if the nodes do not make a road of a map.
    pub fn new(road: &Road) -> Result<Self, RoadProblem> {
        let nodes = || road.nodes().map(|(node, _)| node);
        let point = |node: Node| RoadPoint {
            distance_m: node.distance_m,
            latitude_deg: node.position.latitude_deg,
            longitude_deg: node.position.longitude_deg,
        };
        Ok(Self {
            network: RoadLine::new(nodes().map(point).collect())?.into(),
            truth: nodes()
                .map(|node| (node.distance_m, 100.0 * node.grade))
                .collect(),
        })
    }

    /// Returns the score of a map.
    ///
    /// # Errors
    /// Returns an error if the map has no cell far enough from its ends.
    pub fn score(&self, map: &[MapRow]) -> Result<ScoreRow, Unscorable> {
        score_map(map, &self.truth)
    }
}
