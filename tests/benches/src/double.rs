//! The filters in double precision.

/// What they compute in.
pub type Real = f64;

#[path = "contenders.rs"]
mod contenders;
#[path = "../../../firmware/peers/src/dense.rs"]
pub mod dense;
#[path = "../../../firmware/peers/src/minikalman_filter.rs"]
mod minikalman_filter;
#[path = "../../../firmware/peers/src/model.rs"]
pub mod model;
#[path = "../../../firmware/peers/src/ours.rs"]
mod ours;

pub use contenders::contenders;
