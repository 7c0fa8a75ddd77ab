//! RUN.csv and RUN.parquet: one row per cell of one traversal.

mod cell;
mod file;
mod parquet;
mod row;

pub use cell::{RunCell, RunHash, RunIdentity};
pub(crate) use file::read_cells_into;
#[cfg(feature = "parquet")]
pub use file::table;
pub use file::{each_cell, identity, read, read_cells, write, write_from, write_rows};
pub use parquet::{Origin, outline, session};
pub use row::{RunRow, RunRows};
