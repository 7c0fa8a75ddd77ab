//! Signals: frames become readings.

mod decoding;
mod transport;
