//! The file formats. Output files appear whole or not at all.

pub mod csv;
pub mod data_set;
pub mod kept;
pub mod oracle;
pub mod output;
pub mod parquet;
pub mod row_check;
pub mod run;
pub mod spool;
pub mod truth;
pub mod tuning;
pub mod vehicle;
