//! The persistent state, and serialization.

mod next_drive;
#[cfg(feature = "serde")]
mod serialization;
mod stored_form;
