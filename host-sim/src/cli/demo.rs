//! `roadgrade demo`.

use crate::error::Result;

/// Arguments of `demo`.
#[derive(Debug, clap::Args)]
pub struct Args {}

/// Runs it.
pub fn run(_args: &Args) -> Result<()> {
    Ok(())
}
