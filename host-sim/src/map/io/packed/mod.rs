//! MAP.grade: the map in the form that the vehicle reads. The format stands in
//! [`estimator_core::roadmap`].

mod encode_block;
mod layout;
mod plan_view;
mod unpack;

pub use layout::{pack, stage};
pub use unpack::{open, read};
