//! BMW i3: measured trips of an electric car around Munich, with an accelerometer.
//!
//! M. Steinstraeter, J. Buberger, D. Trifonov (TU Munich), "Battery and Heating Data in Real Driving
//! Cycles", IEEE DataPort 2020, DOI 10.21227/6jr9-5235. A trip is one file, ten rows a second. The
//! publishers put all signals on these times by interpolation: over a gap of the recording, all of
//! them run straight; and the elevation runs straight between points that are minutes apart.
//!
//! * [`Trip`]: its rows, read and written as a signal table;
//! * [`vehicle`]: the assumed parameters of the car.

mod elevation;
mod gaps;
mod header;
mod read;
mod table;
mod trip;
mod vehicle;

pub use trip::{Trip, TripRow};
pub use vehicle::vehicle;
