//! MAP.grade: the map in the form that the vehicle reads. The format stands in
//! [`estimator_core::roadmap`].

mod encode_block;
mod layout;
mod plan_view;
mod unpack;

pub use layout::{pack, stage};
pub(in crate::map::io) use unpack::block_rows;
pub use unpack::{open, read};
