//! The filters in single precision.

/// Number type of the filters.
pub type Real = f32;

#[path = "contenders.rs"]
mod contenders;
#[path = "../../peers/src/dense.rs"]
pub mod dense;
#[path = "../../peers/src/minikalman_filter.rs"]
mod minikalman_filter;
#[path = "../../peers/src/model.rs"]
pub mod model;
#[path = "../../peers/src/ours.rs"]
mod ours;

pub use contenders::contenders;
