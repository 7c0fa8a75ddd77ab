//! `roadgrade study`.

use crate::error::Result;

/// Arguments of `study`.
#[derive(Debug, clap::Args)]
pub struct Args {}

/// Runs it.
pub fn run(_args: &Args) -> Result<()> {
    Ok(())
}
