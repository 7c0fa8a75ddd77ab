//! The blocks of ASAM MDF 4 files, for the reader of frames and that of signals.
//!
//! Written from the public description of the blocks (ASAM MDF 4.1 and 4.2 as in the sources and
//! documents of asammdf).
//!
//! | file | content |
//! |---|---|
//! | `mdf_file` | blocks, their links, texts |
//! | `pieces`, `piece` | the data of a group: blocks, lists of them, compressed or not |
//! | `packed` | compressed blocks |
//! | `records` | the records in these data |
//! | `group` | a channel group: the size of its records |
//! | `field` | numbers and times in a record |
//! | `conversion` | from a raw number to its value |

pub(super) mod conversion;
pub(super) mod field;
pub(super) mod group;
pub(super) mod mdf_file;
mod packed;
pub(super) mod piece;
pub(super) mod pieces;
pub(super) mod records;
