//! The smoother: the fixed lag.

mod fixed_lag;
mod marks;
