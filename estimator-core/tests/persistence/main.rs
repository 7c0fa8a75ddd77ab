//! What outlasts a drive, and what is serialized.

mod next_drive;
#[cfg(feature = "serde")]
mod serialization;
mod stored_form;
