//! Images of the firmware: building them, and reading their sizes and symbols.

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

/// Returns the folder of the measured data, which may be absent.
#[must_use]
pub fn measured_data() -> PathBuf {
    root().join("../shared/data")
}

/// Returns the mission of the measured bus, which may be absent.
#[must_use]
pub fn measured_mission() -> PathBuf {
    measured_data().join("ztbus/B183_2021-07-26_03-53-27_2021-07-26_07-18-47.csv")
}

/// Returns the target folder of cargo.
#[must_use]
pub fn target_folder() -> PathBuf {
    env::var_os("CARGO_TARGET_DIR").map_or_else(|| root().join("target"), Into::into)
}

/// Build profile of the firmware's images.
pub const IMAGE_PROFILE: &str = "dist";

/// Builds all images of a package for a target. Returns their folder.
///
/// # Errors
/// cargo cannot be started, or fails.
pub fn build(package: &Path, target: &str, profile: &str) -> Result<PathBuf> {
    let manifest = package.join("Cargo.toml");
    // Otherwise packages with a workspace of their own get a target folder of their own.
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

/// The sizes of an image, and the panicking functions in it.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Image {
    /// Code, constants and initial values of static memory, bytes.
    pub flash_bytes: u32,
    /// Static memory, bytes.
    pub ram_bytes: u32,
    /// Functions that only a panic calls. The linker keeps reachable functions only, so an image
    /// without them cannot panic.
    pub panics: Vec<String>,
}

impl Image {
    /// Reads an ELF file.
    ///
    /// # Errors
    /// The file cannot be read, or is not an ELF file.
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
