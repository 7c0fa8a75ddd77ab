//! A road-grade estimator for heavy vehicles that runs on the vehicle's own controller.
//!
//! Streaming CAN and GNSS samples in, grade out: the grade under the wheels now, the grade of
//! the last stretch more precisely, and how sure it is of both. `no_std`, no allocation, no
//! `unsafe`, fixed memory.
//!
//! Data flows one way:
//!
//! ```text
//! frame ─► signal ─► sample ─► filter ─► lag ─► cell
//! ```
//!
//! * [`signal`] decodes J1939 and NMEA 2000 frames into physical readings;
//! * [`sampler`] turns readings of different rates and ages into one sample a cell;
//! * [`intake`] is the way from frames to samples, with what was wrong counted;
//! * [`vehicle`] holds the parameters and the force balance; [`effect`] what that balance lacks;
//! * [`filter`] is the Kalman filter, [`lag`] its fixed-lag smoother;
//! * [`cell`] is what comes out;
//! * [`kept`] is what one drive leaves for the next, and its form in non-volatile memory;
//! * [`estimator`] is the facade over all of it: most users need only [`Estimator`].
//!
//! It knows no clock, no bus driver and no log: time is an argument, frames are anything that
//! implements [`embedded_can::Frame`], and what happened is returned and counted.
//!
//! # Contracts
//!
//! * **Non-finite input** never enters the state: readings are checked, counted and left out.
//! * **Panics**: none, whatever arrives.
//! * **Cost**: one filter step and, on average, (lag + block) / block smoothing steps a cell of
//!   2.5 m; each is a fixed number of operations.
//! * **Same input, same output**, bit for bit, on host and target in the same number type: libm
//!   functions, no fused multiply-add, no clock.

#![no_std]
#![forbid(unsafe_code)]
#![warn(missing_docs)]
#![deny(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod angle;
pub mod broadcast;
pub mod cell;
mod clock;
pub mod counters;
mod division;
pub mod effect;
pub mod estimator;
pub mod filter;
pub mod intake;
pub mod kept;
pub mod lag;
pub mod maybe;
pub mod sampler;
pub mod scalar;
pub mod signal;
pub mod time;
pub mod tuning;
pub mod vehicle;

pub use cell::{CELL_LENGTH_M, Cell, Condition, Estimate, Place, Uncertain};
pub use counters::Counters;
pub use effect::{Adopted, Effect, Effects};
pub use estimator::{Estimator, Live, Step};
pub use intake::{Intake, Outcome};
pub use kept::{Kept, KeptError};
pub use maybe::Maybe;
#[cfg(feature = "fixed")]
pub use scalar::Fixed;
pub use scalar::Scalar;
pub use signal::{Decoder, Reading, Signal, Value};
pub use time::{Duration, Instant};
pub use tuning::Tuning;
pub use vehicle::{Driveline, Gear, ParameterError, Powertrain, Traction, VehicleParameters};
