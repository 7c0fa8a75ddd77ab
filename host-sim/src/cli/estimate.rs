//! `roadgrade estimate`.

use crate::error::Result;

/// Arguments of `estimate`.
#[derive(Debug, clap::Args)]
pub struct Args {}

/// Runs it.
pub fn run(_args: &Args) -> Result<()> {
    Ok(())
}
