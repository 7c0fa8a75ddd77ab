//! What carries a way.

/// A structure on which a road leaves the ground. Terrain models show the ground instead.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Structure {
    /// The ground is below the road.
    Bridge,
    /// The ground is above the road.
    Tunnel,
}

impl Structure {
    /// Returns the word that files use, the key of the tag in OpenStreetMap.
    #[must_use]
    pub const fn word(self) -> &'static str {
        match self {
            Self::Bridge => "bridge",
            Self::Tunnel => "tunnel",
        }
    }
}
