//! Images of the firmware: building them, and what can be read off them without running.

use host_sim::error::{Error, Result};
use object::{Object, ObjectSection, ObjectSymbol, SectionKind};
use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::{env, fs};

/// Returns the root of this repository.
#[must_use]
pub fn root() -> PathBuf {
    let tests = Path::new(env!("CARGO_MANIFEST_DIR"));
    tests.parent().unwrap_or(tests).to_owned()
}

/// Returns where cargo builds.
#[must_use]
pub fn target_folder() -> PathBuf {
    env::var_os("CARGO_TARGET_DIR").map_or_else(|| root().join("target"), Into::into)
}

/// Builds all images of a package for a target; returns the folder that they are in.
///
/// # Errors
/// cargo cannot be started, or fails.
pub fn build(package: &Path, target: &str, profile: &str) -> Result<PathBuf> {
    let manifest = package.join("Cargo.toml");
    // Packages with a workspace of their own would have a folder of their own.
    let folder = target_folder();
    let status = Command::new(env::var_os("CARGO").unwrap_or_else(|| OsString::from("cargo")))
        .args(["build", "--quiet", "--bins", "--profile", profile])
        .args(["--target", target, "--manifest-path"])
        .arg(&manifest)
        .arg("--target-dir")
        .arg(&folder)
        .status()
        .map_err(Error::io(&manifest))?;
    if !status.success() {
        return Err(Error::content(&manifest, "its images cannot be built"));
    }
    Ok(folder.join(target).join(profile))
}

/// What an image takes and contains.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Image {
    /// Code, constants and what static memory starts with, bytes.
    pub flash_bytes: u32,
    /// Static memory, bytes.
    pub ram_bytes: u32,
    /// Functions that only a panic calls. A linker keeps what can be reached: with none of them,
    /// the image cannot panic.
    pub panics: Vec<String>,
}

impl Image {
    /// Reads it off an ELF file.
    ///
    /// # Errors
    /// The file cannot be read, or is none.
    pub fn read(path: &Path) -> Result<Self> {
        let bytes = fs::read(path).map_err(Error::io(path))?;
        let file = object::File::parse(&*bytes)
            .map_err(|error| Error::content(path, format!("not an image: {error}")))?;
        let mut image = Self::default();
        for section in file.sections() {
            let bytes = section.size() as u32;
            match section.kind() {
                SectionKind::Text | SectionKind::ReadOnlyData | SectionKind::ReadOnlyString => {
                    image.flash_bytes += bytes;
                }
                SectionKind::Data => {
                    image.flash_bytes += bytes;
                    image.ram_bytes += bytes;
                }
                SectionKind::UninitializedData => image.ram_bytes += bytes,
                _ => {}
            }
        }
        let names = file.symbols().filter_map(|symbol| symbol.name().ok());
        image.panics = names
            .map(|name| format!("{:#}", rustc_demangle::demangle(name)))
            .filter(|name| name.starts_with("core::panicking::"))
            .collect();
        image.panics.sort();
        image.panics.dedup();
        Ok(image)
    }
}
