//! What differs between the systems that the host runs on: Unix, and WebAssembly with a system
//! interface (WASI), as in a browser.

#[cfg(unix)]
mod unix;
#[cfg(not(unix))]
mod wasi;

#[cfg(unix)]
pub use unix::{IS_FOLDER, OUT_OF_FILES, TableFile, file_number, readable_by_all, table_file};
#[cfg(not(unix))]
pub use wasi::{IS_FOLDER, OUT_OF_FILES, TableFile, file_number, readable_by_all, table_file};
