//! `roadgrade listen` and `roadgrade replay` on virtual CAN interfaces.
//!
//! The tests need a kernel with vcan and the right to add interfaces. An ordinary `cargo test`
//! leaves them out. `tests/run vcan` runs them, in a virtual machine if this kernel has no vcan.

#![cfg(target_os = "linux")]

mod babbling;
mod bus;
mod clock;
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

/// Returns the program.
fn roadgrade() -> Command {
    Command::new(env!("CARGO_BIN_EXE_roadgrade"))
}
