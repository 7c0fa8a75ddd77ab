//! Signals of a user's own bus: any `.dbc` file, or the channels of a log, mapped to our signals by a
//! `SIGNALS.toml`.

mod channel_mapping;
pub mod dbc;
mod dbc_attributes;
pub mod dbc_message;
mod dbc_statement;
mod dbc_text;
mod lines;
mod mapping;
pub(super) mod mapping_file;
mod message_parts;
mod message_reference;
pub mod units;

pub use channel_mapping::ChannelMapping;
pub(super) use lines::line_of;
pub use mapping::OwnSignals;
