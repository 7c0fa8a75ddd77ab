//! What others ask of a map: slopes of the edges of a network, and proposals of inclines.

pub mod edges;
pub mod inclines;
pub mod profile;
