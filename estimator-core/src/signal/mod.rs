//! Bus frames in, physical readings out.
//!
//! [`Decoder`] takes any [`embedded_can::Frame`] and returns [`Reading`]s: a [`Signal`], its value in
//! the unit that [`Signal::column`] names, and its source. Layouts come from the `.dbc` files in
//! `estimator-core/dbc`; `build.rs` turns them into tables.

mod decoder;
mod fast_packet;
mod frame_outcome;
mod layout;
mod message_info;
pub mod own_message;
pub mod raw_field;
mod reading;
mod transport;

pub use decoder::Decoder;
pub use frame_outcome::{FrameOutcome, Pgn, Rejection};
pub use layout::Framing;
pub use message_info::{MessageInfo, encode, messages};
pub use reading::{Reading, Signal, Value};

/// The J1939 messages that are read, as a `.dbc` file.
pub const J1939_DBC: &str = include_str!("../../dbc/j1939.dbc");
/// The NMEA 2000 messages that are read, as a `.dbc` file.
pub const NMEA2000_DBC: &str = include_str!("../../dbc/nmea2000.dbc");

/// Number of messages that the decoder knows.
pub(crate) const MESSAGE_COUNT: usize = layout::MESSAGES.len();
/// Index of the message that gives the wheel speed.
pub(crate) use layout::WHEEL_SPEED_MESSAGE;
