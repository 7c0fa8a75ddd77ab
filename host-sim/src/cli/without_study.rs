//! `roadgrade study` where a program is built without it.

use crate::error::{Error, Result};

/// Arguments of `study`.
#[derive(Debug, clap::Args)]
pub struct Args {
    /// Whatever is given.
    #[arg(trailing_var_arg = true, allow_hyphen_values = true, hide = true)]
    _given: Vec<String>,
}

/// Refuses the command.
pub fn run(_args: &Args) -> Result<()> {
    Err(Error::Usage(
        "study: this program is built without the studies; build it with --features studies"
            .to_owned(),
    ))
}
