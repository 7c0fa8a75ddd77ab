//! Commands that a program is built without.

use crate::error::{Error, Result};
use std::path::Path;

/// Any arguments.
#[derive(Debug, clap::Args)]
pub struct Args {
    #[arg(trailing_var_arg = true, allow_hyphen_values = true)]
    given: Vec<String>,
}

fn refuse(args: &Args, problem: &str) -> Result<()> {
    Err(Error::content(Path::new(&args.given.join(" ")), problem))
}

/// `roadgrade replay` and `roadgrade listen` on systems without SocketCAN.
#[cfg(not(target_os = "linux"))]
pub mod can {
    pub use super::Args;
    use crate::error::Result;

    /// Returns the error that SocketCAN is not available.
    pub fn run(args: &Args) -> Result<()> {
        super::refuse(args, "CAN interfaces need SocketCAN, which only Linux has")
    }
}

/// `roadgrade study` without its feature.
#[cfg(not(feature = "studies"))]
pub mod study {
    pub use super::Args;
    use crate::error::Result;

    /// Returns the error that the studies are not there.
    pub fn run(args: &Args) -> Result<()> {
        let problem = "this program is built without the studies; build it with --features studies";
        super::refuse(args, problem)
    }
}
