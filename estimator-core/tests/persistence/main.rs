//! The persistent state, and serialization.

mod next_drive;
mod packed_vehicle;
#[cfg(feature = "serde")]
mod serialization;
mod stored_form;
