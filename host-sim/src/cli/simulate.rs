//! `roadgrade simulate`.

use crate::error::Result;

/// Arguments of `simulate`.
#[derive(Debug, clap::Args)]
pub struct Args {}

/// Runs it.
pub fn run(_args: &Args) -> Result<()> {
    Ok(())
}
