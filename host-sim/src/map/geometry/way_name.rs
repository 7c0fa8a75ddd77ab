//! What a way of a network is called.

use serde::{Deserialize, Serialize};
use std::fmt;

/// In which direction a way is driven.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Direction {
    /// In the order of its points.
    Forward,
    /// Against it.
    Backward,
}

/// What a way of a network is called. Distances on it, and the sign of its grade, are those of its
/// direction.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct WayName {
    pub way: String,
    pub direction: Direction,
}

impl Direction {
    /// As files have it.
    #[must_use]
    pub const fn word(self) -> &'static str {
        match self {
            Self::Forward => "forward",
            Self::Backward => "backward",
        }
    }
}

impl fmt::Display for WayName {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} {}", self.way, self.direction.word())
    }
}
