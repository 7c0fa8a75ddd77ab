//! The option `--like`, the same in every command that identifies a vehicle.

use crate::error::{Error, Result, on_one_line};
use crate::files::vehicle::VehicleFile;
use crate::identify::{Like, class};
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
        let Some(name) = self.like.as_deref() else {
            return Ok(None);
        };
        if let Some(class) = class::named(name) {
            return Ok(Some(Like::Class(class)));
        }
        if let Some(path) = self.file() {
            let file = VehicleFile::read(path)?;
            return Ok(Some(Like::File(Box::new(file))));
        }
        let names: Vec<String> = class::all().into_iter().map(|class| class.name).collect();
        Err(Error::Usage(format!(
            "--like {}: is neither a class nor a file; expected a vehicle file, or one of {}",
            on_one_line(Path::new(name)),
            names.join(", ")
        )))
    }
}
