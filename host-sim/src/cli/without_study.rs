//! `roadgrade study` where a program is built without it.

use crate::error::{Error, Result};
use std::path::Path;

/// Any arguments.
#[derive(Debug, clap::Args)]
pub struct Args {
    #[arg(trailing_var_arg = true, allow_hyphen_values = true)]
    given: Vec<String>,
}

/// Returns the error that the studies are not there.
pub fn run(args: &Args) -> Result<()> {
    let problem = "this program is built without the studies; build it with --features studies";
    Err(Error::content(Path::new(&args.given.join(" ")), problem))
}
