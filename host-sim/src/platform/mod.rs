//! What differs between the systems that the host runs on: Unix, Windows, and WebAssembly with a
//! system interface (WASI), as in a browser.

#[cfg_attr(unix, path = "unix.rs")]
#[cfg_attr(windows, path = "windows.rs")]
#[cfg_attr(not(any(unix, windows)), path = "wasi.rs")]
mod system;

pub use system::{IS_FOLDER, OUT_OF_FILES, TableFile, file_number, readable_by_all, table_file};
