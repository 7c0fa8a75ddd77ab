//! What outlasts a drive, and what is serialized.

#[path = "../common/mod.rs"]
mod common;

mod next_drive;
#[cfg(feature = "serde")]
mod serialization;
mod stored_form;
