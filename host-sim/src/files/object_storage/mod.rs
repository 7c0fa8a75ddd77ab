//! Object storage: objects at `s3://BUCKET/KEY` as files.
//!
//! A command reads files at random and more than once, so its objects are first brought to a
//! temporary folder, each under its bucket and key. What is committed there is sent when it is
//! complete. The rest of the program sees files only.

mod address;
mod client;
mod expected;
mod folder;
mod problem;
mod transfer;

pub use address::ObjectUrl;
pub use folder::{Object, ObjectStorage, Progress, Wanted, bring, send};
