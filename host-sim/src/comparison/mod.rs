//! The thesis's methods as published, weak points included, as reference for the estimator.
//!
//! Everything here works in the distance domain, offline and in double precision, as in the thesis.
//! The points are the core's samples, every 2.5 m.
//!
//! * [`pointwise`]: grade from the vehicle model alone (eq. 9, forward difference);
//! * [`original`]: the three-state filter with switched noise, smoothed;
//! * [`markov`]: the error of GNSS altitude as a Markov chain (section 5);
//! * [`modified`]: mass and bias corrections against a GPS-heavy estimate (section 8).

mod drive;
pub mod markov;
mod method;
pub mod modified;
pub mod original;
pub mod pointwise;

pub use drive::{G, MeasuredDrive, MeasuredPoint, Profile, STEP_M, moving_mean, without_gaps};
pub use method::ComparisonMethod;
