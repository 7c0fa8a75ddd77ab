//! The persistent state, and serialization.

mod kept_delays;
mod next_drive;
mod packed_vehicle;
#[cfg(feature = "serde")]
mod serialization;
mod stored_form;
