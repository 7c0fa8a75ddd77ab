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

    /// Returns its row, counted from the south.
    pub(super) const fn row(self) -> u16 {
        (self.0 >> 16) as u16
    }

    /// Returns the number that stands for it in a file.
    #[must_use]
    pub const fn key(self) -> u32 {
        self.0
    }
}

/// Rows and columns of tiles, the upper halves and the lower halves of their keys.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TileBounds {
    /// The southernmost row and the westernmost column.
    pub least: [u16; 2],
    /// The northernmost row and the easternmost column.
    pub most: [u16; 2],
}

impl Default for TileBounds {
    /// Returns those of no place.
    fn default() -> Self {
        Self {
            least: [u16::MAX; 2],
            most: [0; 2],
        }
    }
}

impl TileBounds {
    /// Includes a tile.
    pub(super) fn include(&mut self, tile: Tile) {
        let key = tile.key();
        for (i, number) in [(key >> 16) as u16, key as u16].into_iter().enumerate() {
            self.least[i] = self.least[i].min(number);
            self.most[i] = self.most[i].max(number);
        }
    }

    /// Includes all tiles of others.
    pub(super) fn unite(&mut self, other: &Self) {
        for i in 0..2 {
            self.least[i] = self.least[i].min(other.least[i]);
            self.most[i] = self.most[i].max(other.most[i]);
        }
    }

    /// Returns whether a tile is within.
    #[must_use]
    pub const fn contains(&self, tile: Tile) -> bool {
        let (row, column) = ((tile.0 >> 16) as u16, tile.0 as u16);
        self.least[0] <= row
            && row <= self.most[0]
            && self.least[1] <= column
            && column <= self.most[1]
    }
}

/// Returns the upper 16 bits of an angle with the sign bit flipped: south comes before north, west
/// before east.
const fn rank(angle_e7: i32) -> u32 {
    (angle_e7.cast_unsigned() ^ (1 << 31)) >> 16
}

/// What a short look for the next block with a cell in a tile gives.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Looked {
    /// A block with a cell in the tile, by its offset.
    Block(u32),
    /// None so far.
    NotYet,
    /// There are no more.
    End,
}
