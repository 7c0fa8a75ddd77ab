//! The thesis as it stands: what the estimator has to beat, weak points included.
//!
//! Everything here works in the distance domain, on points of 2.5 m that the core's sampler cut
//! from the traffic, offline and in double precision, as the thesis does.
//!
//! * [`pointwise`]: grade from the vehicle model alone (eq. 9, forward difference);
//! * [`original`]: the three-state filter with switched noise, smoothed;
//! * [`markov`]: the error of GNSS altitude as a Markov chain (section 5);
//! * [`modified`]: mass and bias corrections found against a GPS-heavy estimate (section 8).

mod drive;
pub mod markov;
mod method;
pub mod modified;
pub mod original;
pub mod pointwise;

pub(crate) use drive::G;
pub use drive::{MeasuredDrive, MeasuredPoint, Profile, STEP_M, moving_mean, without_gaps};
pub use method::ComparisonMethod;
