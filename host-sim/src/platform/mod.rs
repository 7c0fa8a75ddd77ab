//! What differs between the systems that the host runs on: Unix, Windows, and WebAssembly with a
//! system interface (WASI), as in a browser.

mod error_codes;
#[cfg_attr(unix, path = "unix_files.rs")]
#[cfg_attr(not(unix), path = "other_files.rs")]
mod files;
#[cfg_attr(target_family = "wasm", path = "table_in_memory.rs")]
#[cfg_attr(not(target_family = "wasm"), path = "table_on_disk.rs")]
mod table;

pub use error_codes::{IS_FOLDER, OUT_OF_FILES};
pub use files::{file_number, readable_by_all};
pub use table::{TableFile, table_file};
