//! The file that stands for an ECU's non-volatile memory: one [`PersistentState`] as bytes.

use super::output::{self, Staged};
use crate::error::{Error, Result};
use estimator_core::{Model, PersistentState};
use std::fs;
use std::io::ErrorKind;
use std::path::Path;

/// What the last drive of this vehicle left; `None` if there is no such file.
///
/// # Errors
/// A file that cannot be read, is damaged or something else, or is another vehicle's.
pub fn read(path: &Path, model: &Model) -> Result<Option<PersistentState>> {
    let bytes = match fs::read(path) {
        Err(e) if e.kind() == ErrorKind::NotFound => return Ok(None),
        bytes => bytes.map_err(Error::io(path))?,
    };
    let kept = PersistentState::from_bytes(&bytes).and_then(|kept| {
        kept.check_model(model)?;
        Ok(kept)
    });
    kept.map(Some).map_err(|refusal| {
        let expected = "expected what this vehicle's last drive left, or no file";
        Error::content(path, format!("{refusal}; {expected}"))
    })
}

/// Writes what this drive leaves, to appear when committed.
///
/// # Errors
/// What the file system says.
pub fn stage(path: &Path, kept: &PersistentState) -> Result<Staged> {
    output::stage(path, |out| out.write_all(&kept.to_bytes()))
}
