//! Helpers of the tests across packages.

pub mod accuracy;
pub mod budgets;
pub mod change_indicator;
pub mod diagnosed;
pub mod docs;
pub mod drive;
pub mod drive_map;
pub mod emulator;
pub mod fault_page;
pub mod faults;
pub mod image;
pub mod large_map;
pub mod manoeuvres;
pub mod peers;
pub mod planted;
pub mod sensitivity;
pub mod verdict;

use host_sim::error::Result;
use std::process::ExitCode;

/// Returns the exit code of a program of this package. Prints an error on stderr.
#[must_use]
pub fn exit_code(result: Result<()>) -> ExitCode {
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("{error}");
            ExitCode::FAILURE
        }
    }
}
