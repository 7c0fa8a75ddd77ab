//! The bench of manoeuvres and faults: does each error lie within what its sigma says, or is the
//! estimate marked there?
//!
//! ```text
//! catalogue, random ─► plan ─► drive (simulator) ─► frames with edits ─► run ─► judgement ─► table
//! ```
//!
//! [`road`] has the road, [`drives`] the plan of a drive, [`truth`] what was true of it, [`signals`]
//! the changes of what frames say, [`catalogue`] the manoeuvres by name, [`random`] combinations of them,
//! [`cells`] the cells beside the truth, [`mass`] the stated mass beside the true one, [`judge`] the
//! numbers and bars, [`table`] the print, and [`page`] the parts of `tests/faults.md`.

pub mod bench;
pub mod catalogue;
pub mod cells;
pub mod drives;
pub mod judge;
pub mod low_pass;
pub mod mass;
pub mod page;
pub mod parts;
pub mod random;
pub mod road;
pub mod signals;
pub mod table;
pub mod torque_edit;
pub mod truth;
