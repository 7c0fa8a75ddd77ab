//! What is on a bus: messages, senders, rates, the range of each signal, and what an estimate
//! would miss.

pub mod census;
mod log;
pub mod needs;
pub mod pgn_names;
pub mod text;

pub use log::census_of;
