//! What carries a way, or lies beside it.

/// A structure where a road leaves the ground around it. Terrain models show the ground instead.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Structure {
    /// The ground is below the road.
    Bridge,
    /// The ground is above the road.
    Tunnel,
    /// The ground beside the road is above it.
    Cutting,
    /// The ground beside the road is below it.
    Embankment,
}

impl Structure {
    /// All of them. Where a way has two, the first of them counts: it is farther from the ground.
    pub const ALL: [Self; 4] = [Self::Bridge, Self::Tunnel, Self::Cutting, Self::Embankment];

    /// Returns the word that files use, the key of the tag in OpenStreetMap.
    #[must_use]
    pub const fn word(self) -> &'static str {
        match self {
            Self::Bridge => "bridge",
            Self::Tunnel => "tunnel",
            Self::Cutting => "cutting",
            Self::Embankment => "embankment",
        }
    }
}
