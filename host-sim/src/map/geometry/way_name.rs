//! Names of the ways of a network.

use serde::{Deserialize, Serialize};
use std::fmt;

/// Direction in which a way is driven.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum WayDirection {
    /// In the order of its points.
    Forward,
    /// Against the order of its points.
    Backward,
}

/// Name of a way. Distances along it and the sign of its grade follow its direction.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct WayName {
    /// Name in the file of the network.
    pub way: String,
    /// Direction in which it is driven.
    pub direction: WayDirection,
}

impl WayDirection {
    /// Returns the word that files use.
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
