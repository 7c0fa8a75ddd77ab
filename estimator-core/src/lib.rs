//! A road-grade estimator for heavy vehicles that runs on the vehicle's own controller.
//!
//! It takes streaming CAN and GNSS samples. It returns the grade under the wheels now, the grade of
//! the last stretch more precisely, and the standard deviation of both. It is `no_std`, allocates
//! nothing, contains no `unsafe`, and its memory is fixed.
//!
//! # Layers
//!
//! Data flow in one direction, and no layer knows the one above it:
//!
//! ```text
//! frame ─► signal ─► intake ─► sampler ─► sample ─► filter ─► inference ─► cell
//! ```
//!
//! * [`estimator`] is the facade over all of it. Most users need only [`Estimator`].
//! * [`signal`] decodes J1939 and NMEA 2000 frames into readings with units. It is a layer of its own
//!   because buses differ and physics does not: another message is a line in a `.dbc` file.
//! * [`intake`] decides which readings count: one source for each signal, time that only goes
//!   forward, rates that one sender can have. It stands before the sampler so that nothing behind it
//!   has to distrust a reading's origin.
//! * [`sampler`] turns readings of different rates and ages into one [`Sample`] a
//!   cell of 2.5 m. After it, time is distance: in the distance domain every equation is linear.
//! * [`filter`] is the Kalman filter with its backward step, [`inference`] decides how much each noise
//!   counts, and smooths. Neither knows a signal.
//! * [`vehicle`] holds parameters and force balance, [`effect`] what that balance lacks, [`model`]
//!   both together.
//! * [`context`] is what these parts share: the model, the [`tuning`] and the [`counters`].
//! * [`packed_vehicle`] is a model as bytes, in [records of words](word_record).
//! * [`delay`] is how late receiver and force are found to be.
//! * [`persistent_state`] is what one drive leaves for the next; [`broadcast`] is the estimate as CAN
//!   frames for other nodes.
//!
//! # What it is not
//!
//! * It is **not** a bus driver, a scheduler or a logger. Time is an argument, frames are anything
//!   that implements [`embedded_can::Frame`], and what happened is returned and counted.
//! * It does **not** make maps. Fusion of runs into maps is done on a host; [`roadmap`] reads them.
//! * It is **not** a position estimator. Positions pass through it unfiltered.
//! * It is **not** for vehicles without a known traction force: it needs engine torque and gear, or a
//!   measured force.
//!
//! # Contracts
//!
//! * **Non-finite input** never enters the state. Readings are checked, counted and rejected.
//! * **Panics**: none, with any input.
//! * **Cost**: a call of [`Estimator::step`] moves over one cell, or does a share of the smoothing
//!   behind the vehicle. Both are bounded. `firmware/budgets.csv` counts them.
//! * **Same input, same output**, bit for bit, on host and target with the same number type: libm
//!   functions, no fused multiply-add, no clock.

#![no_std]
#![forbid(unsafe_code)]
#![warn(missing_docs)]
#![deny(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod angle;
pub mod broadcast;
pub mod cell;
pub mod context;
pub mod counters;
pub mod delay;
mod division;
pub mod effect;
pub mod estimator;
pub mod filter;
pub mod inference;
pub mod intake;
pub mod maybe;
pub mod model;
pub mod packed_vehicle;
pub mod persistent_state;
pub mod roadmap;
pub mod sample;
pub mod sampler;
pub mod scalar;
pub mod signal;
pub mod time;
pub mod tuning;
pub mod vehicle;
pub mod word_record;

pub use cell::{CELL_LENGTH_M, Cell, CellEnd, Condition, Disagreement, Estimate, Live, Uncertain};
pub use context::Context;
pub use counters::Counters;
pub use delay::{Delay, Delays};
pub use effect::Effect;
pub use estimator::{Estimator, Step};
pub use intake::{Intake, Outcome};
pub use maybe::Maybe;
pub use model::{AdoptedEffect, AdoptedEffects, Model};
pub use persistent_state::{PersistentState, PersistentStateError};
pub use sample::Sample;
pub use sampler::Sampler;
#[cfg(feature = "fixed")]
pub use scalar::FixedPoint;
pub use scalar::Scalar;
pub use signal::{Decoder, Reading, Signal, Value};
pub use time::{Duration, Instant};
pub use tuning::Tuning;
pub use vehicle::{Driveline, Gear, ParameterError, Powertrain, Traction, VehicleParameters};
