//! ZTBus: measured missions of Zurich's articulated trolleybuses.
//!
//! F. Widmer, A. Ritter, C. H. Onder, "ZTBus: A Large Dataset of Time-Resolved City Bus Driving
//! Missions", Scientific Data 10:687 (2023); called "the paper" below. A mission is everything
//! from switching the bus on to switching it off, one row a second.

mod mission;
mod read;
mod split;
mod table;
mod turning;

pub use mission::{KERB_MASS_KG, Mission, MissionRow, PASSENGER_MASS_KG};
pub use split::{Pass, PassDirection, round_trips};
