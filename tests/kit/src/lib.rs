//! Helpers of the tests of all packages.

#[cfg(feature = "mdf")]
pub mod archive;
#[cfg(feature = "host")]
pub mod command;
#[cfg(feature = "host")]
pub mod damage;
mod digests;
pub mod effect_drive;
pub mod electric_car;
mod frames;
pub mod hilly_drive;
pub mod late_drive;
#[cfg(feature = "mdf")]
pub mod mdf;
#[cfg(feature = "mdf")]
pub mod mdf_signals;
mod noise;
mod on_map;
#[cfg(feature = "mdf")]
pub mod osm;
#[cfg(feature = "mdf")]
pub mod pcap;
pub mod readings_drive;
#[cfg(feature = "host")]
pub mod roads;
mod samples;
#[cfg(feature = "host")]
pub mod simulated;
#[cfg(feature = "host")]
pub mod tables;
mod trucks;
pub mod varint;

pub use digests::{Digest, check_digests};
pub use frames::{TO_ALL, TRANSPORT_DATA, TRANSPORT_MANAGEMENT, TestFrame, frames_of, session_of};
pub use noise::Noise;
pub use on_map::{finished_late, line_on_map};
pub use samples::{altitude, sample, speed};
pub use trucks::{by_force, truck, truck_with};
