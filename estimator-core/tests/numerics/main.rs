//! Numbers and matrices: fixed point and the packed covariance.

mod covariance;
#[cfg(feature = "fixed")]
mod fixed_point;
