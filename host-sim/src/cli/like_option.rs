//! The option `--like`, the same in every command that identifies a vehicle.

use crate::error::{Error, Result};
use crate::identify::Like;
use std::path::Path;

/// The option `--like`.
#[derive(Debug, clap::Args)]
pub struct LikeOption {
    /// What the vehicle is like: a class, or another vehicle file. Default: recognised by its mass.
    #[arg(long, value_name = "CLASS|V.toml")]
    like: Option<String>,
}

impl LikeOption {
    /// Returns the vehicle file, if one is named.
    pub fn file(&self) -> Option<&Path> {
        let path = self.like.as_deref().map(Path::new);
        path.filter(|path| path.is_file())
    }

    /// Returns the class or the file that is named, if any.
    ///
    /// # Errors
    /// Returns a usage error that names the classes, or the error of the vehicle file.
    pub fn read(&self) -> Result<Option<Like>> {
        let like = self.like.as_deref().map(Like::named).transpose();
        like.map_err(|error| match error {
            Error::Usage(problem) => Error::Usage(format!("--like {problem}")),
            error => error,
        })
    }
}
