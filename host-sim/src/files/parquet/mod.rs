//! Tables of numbers as Parquet: column names as in the CSV files, units in the metadata.

mod guard;
mod number_column;
mod pages;
mod read;
mod write;

pub use number_column::NumberColumn;
pub use read::{NumberBatches, Opened, open};
pub use write::{GEO, ParquetColumn, TableWriter, VERTICAL_DATUM, in_memory, stage};

use std::path::Path;

/// Returns true if the name of the file ends in `.parquet`.
#[must_use]
pub fn is_parquet(path: &Path) -> bool {
    path.extension()
        .is_some_and(|extension| extension.eq_ignore_ascii_case("parquet"))
}
