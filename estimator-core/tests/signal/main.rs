//! Signals: frames become readings.

mod decoding;
mod inertial;
mod own_messages;
mod transport;
