//! `roadgrade listen` and `roadgrade replay` on virtual CAN interfaces.
//!
//! They need a kernel with vcan and the right to make interfaces, and so are left out of an ordinary
//! `cargo test`; `tests/run vcan` runs them, in a virtual machine where this kernel has none.

#![cfg(target_os = "linux")]

mod babbling;
mod bus;
mod drive;
mod events;
mod listener;
mod load;
mod lost_interface;
mod peers;
mod publish;
mod recording;
mod same_cells;
mod watching;

use assert_cmd::Command;

/// The program.
fn roadgrade() -> Command {
    Command::new(env!("CARGO_BIN_EXE_roadgrade"))
}
