//! The file formats. Output files appear whole or not at all.

pub mod columns;
pub mod csv;
pub mod data_set;
pub mod flash_image;
mod flaw;
pub mod geo_parquet;
pub mod kept;
pub mod kind;
pub mod limits;
pub mod lock;
pub mod log_format;
pub mod nearest;
pub mod oracle;
pub mod output;
pub mod parquet;
pub mod parquet_column;
mod parquet_pages;
pub mod row_check;
pub mod run;
pub(crate) mod same;
pub mod signals;
pub mod spool;
pub mod temporary;
pub mod truth;
pub mod tuning;
pub mod utc;
pub mod vehicle;
