//! The vehicle file that logs ask for: read off the bus, measured, or assumed.
//!
//! * [`observation`]: what the readings of a log show; [`ratio_histogram`] and [`gears`]: the gears
//!   of the gearbox from engine speed over wheel speed;
//! * [`class`]: what is usual in classes of vehicles;
//! * [`fit`]: resistance, drag, traction and mass from the innovations of the filter;
//! * [`delays`]: how late receiver and force are;
//! * [`procedure`]: all steps; [`draft`]: the vehicle while it is identified; [`account`]: each
//!   value with its origin, and what remains unknown; [`identified`]: the result, of
//!   [`estimate`]s;
//! * [`annotated`]: the vehicle file with a comment at each value.

pub mod account;
pub mod annotated;
pub mod class;
pub mod delays;
pub mod draft;
pub mod estimate;
pub mod fit;
pub mod gears;
pub mod identified;
mod limits;
pub mod observation;
mod one_vehicle;
pub mod procedure;
pub mod ratio_histogram;

pub use estimate::{Estimate, Unknown};
pub use identified::{Identified, IdentifiedValue, Origin};
pub use procedure::{Like, Request, identify};
