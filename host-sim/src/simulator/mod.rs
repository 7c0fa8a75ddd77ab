//! The simulator: trucks with known parameters on a road with known grade, and their CAN data.
//!
//! ```text
//! scenario ─► road ─► drive (truck, driver, gearbox) ─► sensors, GNSS ─► bus frames
//!                       └► truth
//! ```
//!
//! The scenario and its seed determine everything: the same scenario gives the same frames, byte
//! for byte. [`simulate`] returns a run in memory; [`Recording`] returns its frames one by one.

mod broadcasts;
pub mod bus;
pub mod drive;
pub mod driver;
pub mod gearbox;
pub mod geodesy;
pub mod gnss;
pub mod inertial;
pub mod inertial_file;
pub mod manoeuvre_file;
pub mod manoeuvres;
mod oracle;
pub mod planted;
pub mod planted_file;
pub mod random;
mod range_check;
mod recording;
pub mod road;
pub mod road_file;
pub mod road_generator;
pub mod scenario;
mod scenario_check;
pub mod scenario_file;
pub mod sensor_file;
pub mod sensors;
pub mod surroundings_file;
pub mod truck;
mod unmodelled;
mod write_runs;

pub use recording::{Recording, SimulatedRun, simulate};
pub use unmodelled::Unmodelled;
pub use write_runs::{WrittenRun, files_of, write_runs};
