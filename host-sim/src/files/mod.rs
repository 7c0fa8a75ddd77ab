//! The file formats. Output files appear whole or not at all.

pub mod columns;
pub mod csv;
pub mod data_set;
pub mod flash_image;
mod flaw;
pub mod folder;
pub mod geo_parquet;
pub mod kept;
pub mod kind;
pub mod left_out;
pub mod limits;
pub mod lock;
pub mod log_format;
pub(crate) mod marks;
pub mod nearest;
#[cfg(all(unix, feature = "s3"))]
pub mod object_storage;
#[cfg(not(all(unix, feature = "s3")))]
#[path = "without_object_storage.rs"]
pub mod object_storage;
pub mod oracle;
pub mod output;
pub mod parquet;
pub mod row_check;
pub mod run;
pub(crate) mod same;
#[cfg(unix)]
pub mod signals;
#[cfg(not(unix))]
#[path = "without_signals.rs"]
pub mod signals;
pub mod spool;
pub mod stop;
pub mod temporary;
pub mod truth;
pub mod tuning;
pub(crate) mod unpacked;
pub mod utc;
pub mod vehicle;
