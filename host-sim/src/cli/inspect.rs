//! `roadgrade inspect`.

use crate::error::Result;

/// Arguments of `inspect`.
#[derive(Debug, clap::Args)]
pub struct Args {}

/// Runs it.
pub fn run(_args: &Args) -> Result<()> {
    Ok(())
}
