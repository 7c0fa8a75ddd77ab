//! Signals: frames become readings.

mod decoding;
mod own_messages;
mod transport;
