//! Directions of travel.

/// Direction of travel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Heading {
    /// Towards Nyköping.
    South,
    /// Towards Södertälje.
    North,
}

impl Heading {
    /// Both, in the thesis's order.
    pub const BOTH: [Self; 2] = [Self::South, Self::North];

    /// Returns the direction in words.
    #[must_use]
    pub const fn word(self) -> &'static str {
        match self {
            Self::South => "southbound",
            Self::North => "northbound",
        }
    }
}
