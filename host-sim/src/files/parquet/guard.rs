//! Damage that decoders meet with an error or a panic.

use crate::error::{Error, Result, out_of_files};
use std::cell::Cell;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;
use std::sync::Once;

/// Runs `decode` and reports a panic as damage. Decoders can panic on damaged files (an index out
/// of range in a page); that must not end a fusion of thousands of files. The caller discards all
/// changes of `decode`.
pub fn guarded<T>(path: &Path, decode: impl FnOnce() -> Result<T>) -> Result<T> {
    catch_quietly(decode).unwrap_or_else(|| Err(damaged(path, "its pages cannot be decoded")))
}

/// Returns the result of `attempt`, or `None` if it panics. The panic is not printed. The panic
/// hook is set once for all threads: it is silent for this thread, and calls the previous hook for
/// the others.
fn catch_quietly<T>(attempt: impl FnOnce() -> T) -> Option<T> {
    static HOOK: Once = Once::new();
    thread_local! {
        static QUIET: Cell<bool> = const { Cell::new(false) };
    }
    HOOK.call_once(|| {
        let before = std::panic::take_hook();
        std::panic::set_hook(Box::new(move |panic| {
            if !QUIET.get() {
                before(panic);
            }
        }));
    });
    QUIET.set(true);
    let result = catch_unwind(AssertUnwindSafe(attempt));
    QUIET.set(false);
    result.ok()
}

/// Returns the error of a file that cannot be decoded.
pub fn damaged(path: &Path, problem: &str) -> Error {
    // The decoder opens the file again and again.
    if let Some(error) = out_of_files(problem) {
        return Error::io(path)(error);
    }
    // A build may lack a codec: that of the page in a browser has no Zstandard.
    if let Some((_, codec)) = problem.split_once("Disabled feature at compile time: ") {
        let problem =
            format!("pages are packed with {codec}; expected Snappy, gzip, LZ4 or Brotli");
        return Error::content(path, problem);
    }
    Error::content(
        path,
        format!("damaged, or not a Parquet file: {problem}; restore the file as it was written"),
    )
}
