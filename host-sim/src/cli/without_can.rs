//! `roadgrade replay` and `roadgrade listen` on systems without SocketCAN.

use crate::error::{Error, Result};
use std::path::Path;

/// Any arguments.
#[derive(Debug, clap::Args)]
pub struct Args {
    #[arg(trailing_var_arg = true, allow_hyphen_values = true)]
    given: Vec<String>,
}

/// Returns the error that SocketCAN is not available.
pub fn run(args: &Args) -> Result<()> {
    let bus = args.given.join(" ");
    let problem = "CAN interfaces need SocketCAN, which only Linux has";
    Err(Error::content(Path::new(&bus), problem))
}
