//! Tables of numbers as Parquet: column names as in the CSV files, units in the metadata.

#[cfg(feature = "parquet")]
mod guard;
#[cfg(feature = "parquet")]
mod number_column;
#[cfg(feature = "parquet")]
mod pages;
#[cfg(feature = "parquet")]
mod read;
#[cfg(not(feature = "parquet"))]
mod without;
#[cfg(feature = "parquet")]
mod write;

#[cfg(feature = "parquet")]
pub use number_column::NumberColumn;
#[cfg(feature = "parquet")]
pub use read::{NumberBatches, Opened, open};
#[cfg(not(feature = "parquet"))]
pub use without::{NumberBatches, NumberColumn, Opened, ParquetColumn, TableWriter, open, stage};
#[cfg(feature = "parquet")]
pub use write::{ParquetColumn, TableWriter, in_memory, stage};

use crate::error::{Error, Result};
use std::path::Path;

/// What altitudes refer to, in the metadata of files: the receiver decides.
pub const VERTICAL_DATUM: &str =
    "mean sea level, as the GNSS receiver reports it (by its own geoid model)";
/// Key of the metadata of GeoParquet, which has no prefix.
pub const GEO: &str = "geo";

/// Returns true if the name of the file ends in `.parquet`.
#[must_use]
pub fn is_parquet(path: &Path) -> bool {
    path.extension()
        .is_some_and(|extension| extension.eq_ignore_ascii_case("parquet"))
}

/// Checks, before the work begins, that a file can be written: Parquet is a feature of the program.
///
/// # Errors
/// Returns an error for Parquet in a program without it.
pub fn check_output(path: &Path) -> Result<()> {
    if cfg!(not(feature = "parquet")) && is_parquet(path) {
        return Err(without(path));
    }
    Ok(())
}

/// Returns the error of a program without Parquet.
fn without(path: &Path) -> Error {
    let problem = "a Parquet file, which this program is built without; build it with \
                   --features parquet, or use CSV";
    Error::content(path, problem)
}
