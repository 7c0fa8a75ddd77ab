//! Tiles of the spatial index.

/// A rectangle of latitude and longitude, some 730 m high.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Tile(u32);

impl Tile {
    /// Returns the tile of a place in 10⁻⁷ degrees.
    #[must_use]
    pub const fn of(latitude_e7: i32, longitude_e7: i32) -> Self {
        Self((rank(latitude_e7) << 16) | rank(longitude_e7))
    }

    /// Returns the number that stands for it in a file.
    #[must_use]
    pub const fn key(self) -> u32 {
        self.0
    }
}

/// Returns the upper 16 bits of an angle with the sign bit flipped: south comes before north, west
/// before east.
const fn rank(angle_e7: i32) -> u32 {
    (angle_e7.cast_unsigned() ^ (1 << 31)) >> 16
}
