//! The smoother: the fixed lag.

#[path = "../common/mod.rs"]
mod common;

mod fixed_lag;
