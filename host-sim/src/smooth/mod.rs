//! smooth.
