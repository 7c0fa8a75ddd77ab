//! The grade that an accelerometer shows: an independent judge of estimates and of force models
//! (docs/theory/inertial-judge.md).
//!
//! A longitudinal accelerometer reads motion and gravity, a = dv/dt + g·sin(slope). Multiplied by
//! the speed and summed over time, this is ∫a ds = Δ(v²/2) + g·Δz: the climb between two places
//! needs the speeds at both and the accelerations between them, and no force, mass, or altitude.
//! Standstill adds nothing.
//!
//! The judge has errors of its own. Offset and mounting angle are constant over a drive: they are
//! in every window, and who compares removes the mean of the differences and reports it apart. The
//! sigma of a window has the rest: noise of the road and of curves, the resolution of the speed at
//! both ends, and the time between both sensors.
//!
//! * [`profile`]: driven distance and climb at each time;
//! * [`stretch`]: climb and motion between two points of it;
//! * [`windows`](mod@windows): mean grade and sigma of windows.

pub mod profile;
pub mod stretch;
pub mod windows;

pub use profile::{InertialProfile, ProfilePoint};
pub use stretch::Stretch;
pub use windows::{Window, noise_percent, windows, windows_of};
