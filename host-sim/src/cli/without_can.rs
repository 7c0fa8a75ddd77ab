//! `roadgrade replay` and `roadgrade listen` where there is no SocketCAN.

use crate::error::{Error, Result};
use std::path::Path;

/// Whatever was given.
#[derive(Debug, clap::Args)]
pub struct Args {
    #[arg(trailing_var_arg = true, allow_hyphen_values = true)]
    given: Vec<String>,
}

/// Says why not.
pub fn run(args: &Args) -> Result<()> {
    let bus = args.given.join(" ");
    let problem = "CAN interfaces are SocketCAN's, which only Linux has";
    Err(Error::content(Path::new(&bus), problem))
}
