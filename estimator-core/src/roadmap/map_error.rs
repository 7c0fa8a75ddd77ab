//! Why a packed map, or a part of it, cannot be read.

use core::fmt;

/// Why a packed map, or a part of it, cannot be read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum MapError {
    /// The bytes do not start with the magic number: something else.
    Magic,
    /// Another release wrote the map, with this version of the format.
    Version(u32),
    /// The map is longer than its bytes.
    CutOff,
    /// A record is damaged.
    Checksum,
    /// A record says what cannot be, although its checksum is right.
    Content,
}

impl fmt::Display for MapError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Magic => f.write_str("not a packed map"),
            Self::Version(version) => write!(
                f,
                "a packed map of version {version}, which this release does not read"
            ),
            Self::CutOff => f.write_str("a packed map that is cut off"),
            Self::Checksum => f.write_str("a packed map that is damaged"),
            Self::Content => f.write_str("a packed map with impossible content"),
        }
    }
}

impl core::error::Error for MapError {}
