//! The file of a vehicle's persistent state: one [`PersistentState`] as bytes. It stands for an
//! ECU's non-volatile memory.

use super::limits::read_bytes;
use super::output::{self, Staged};
use crate::error::{Error, Result};
use estimator_core::{Model, PersistentState};
use std::io::ErrorKind;
use std::path::Path;

/// A state has far fewer bytes.
const MOST_BYTES: u64 = 1 << 20;

/// Reads the persistent state of the vehicle's last drive; `None` if there is no such file.
///
/// # Errors
/// Returns an error if the file cannot be read, is damaged or something else, or belongs to another
/// vehicle.
pub fn read(path: &Path, model: &Model) -> Result<Option<PersistentState>> {
    let bytes = match read_bytes(path, MOST_BYTES) {
        Err(Error::Io { source, .. }) if source.kind() == ErrorKind::NotFound => return Ok(None),
        bytes => bytes?,
    };
    let kept = PersistentState::from_bytes(&bytes).and_then(|kept| {
        kept.check_model(model)?;
        Ok(kept)
    });
    kept.map(Some).map_err(|refusal| {
        let expected = "expected the persistent state of this vehicle's last drive, or no file";
        Error::content(path, format!("{refusal}; {expected}"))
    })
}

/// Writes the persistent state to a file that appears when it is committed.
///
/// # Errors
/// Returns the error of the file system.
pub fn stage(path: &Path, state: &PersistentState) -> Result<Staged> {
    output::stage(path, |out| out.write_all(&state.to_bytes()))
}
