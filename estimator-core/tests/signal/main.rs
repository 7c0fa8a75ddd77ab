//! Signals: frames become readings.

mod decoding;
