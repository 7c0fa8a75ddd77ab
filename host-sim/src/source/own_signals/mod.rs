//! Signals of a user's own bus: any `.dbc` file, mapped to our signals by a `SIGNALS.toml`.

pub mod dbc;
mod dbc_attributes;
pub mod dbc_message;
mod dbc_statement;
mod dbc_text;
mod lines;
mod mapping;
mod mapping_file;
mod message_parts;
mod message_reference;
pub mod units;

pub(super) use lines::line_of;
pub use mapping::OwnSignals;
