//! Content of a bus: messages, source addresses, rates, the range of each signal, and missing
//! inputs of an estimate.

pub mod census;
pub mod channels;
pub mod columns;
pub mod dbc_census;
mod log;
pub mod needs;
pub mod pgn_names;
pub mod proposal;
pub mod text;

pub use log::census_of;
