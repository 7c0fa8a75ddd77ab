//! The file formats. Output files appear whole or not at all.

/// CSV files with a header.
pub mod csv;
/// Runs in Hive's layout.
pub mod data_set;
/// The file of a vehicle's persistent state.
pub mod kept;
/// `oracle.toml`.
pub mod oracle;
/// Output files that appear whole or not at all.
pub mod output;
/// Parquet tables.
pub mod parquet;
/// Checks of CSV rows.
pub mod row_check;
/// RUN.csv and RUN.parquet.
pub mod run;
/// Temporary storage on disk.
pub mod spool;
/// TRUTH.csv.
pub mod truth;
/// The file of `--tuning`.
pub mod tuning;
/// `vehicle.toml`.
pub mod vehicle;
