//! Ends of the program by a signal: temporary files are removed first.

use crate::error::{Error, Result};
use signal_hook::consts::{SIGINT, SIGTERM, SIGXFSZ};
use signal_hook::flag::register;
use signal_hook::iterator::Signals;
use signal_hook::low_level::emulate_default_handler;
use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, Once, OnceLock, PoisonError};

/// Paths to remove if a signal ends the program.
static PATHS: Mutex<BTreeSet<PathBuf>> = Mutex::new(BTreeSet::new());
/// True if the first signal is an orderly end, and the second one ends the program.
static IS_ORDERLY: AtomicBool = AtomicBool::new(false);
/// What is done before a signal ends the program, after the files are removed.
static LAST_WORK: OnceLock<fn()> = OnceLock::new();
/// True if another program has this library in it, and handles the signals itself.
static IS_GUEST: AtomicBool = AtomicBool::new(false);

/// Makes a file or folder, which is removed if SIGINT or SIGTERM ends the program.
///
/// # Errors
/// Returns the error of `make`.
pub(super) fn removed_at_end<T, E>(
    make: impl FnOnce() -> std::result::Result<T, E>,
    path: impl FnOnce(&T) -> &Path,
) -> std::result::Result<T, E> {
    watch();
    // Signals wait meanwhile, so nothing is made that they do not know.
    let mut paths = paths();
    let made = make()?;
    paths.insert(path(&made).to_owned());
    Ok(made)
}

/// Undoes [`removed_at_end`].
pub(super) fn forget(path: &Path) {
    paths().remove(path);
}

/// Lets a signal call `work` before it ends the program. Only the first call counts.
#[cfg(feature = "s3")]
pub(super) fn before_end(work: fn()) {
    let _ = LAST_WORK.set(work);
}

/// Returns a flag that SIGINT and SIGTERM set. A second signal ends the program at once.
///
/// # Errors
/// Returns an error if a handler cannot be installed.
pub fn stop_flag() -> Result<Arc<AtomicBool>> {
    let stop = Arc::new(AtomicBool::new(false));
    IS_ORDERLY.store(true, Ordering::SeqCst);
    watch();
    for signal in [SIGINT, SIGTERM] {
        register(signal, Arc::clone(&stop)).map_err(Error::io(Path::new("signal handler")))?;
    }
    Ok(stop)
}

fn paths() -> MutexGuard<'static, BTreeSet<PathBuf>> {
    PATHS.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Leaves all signals to the program that has this library in it, from now on. It ends the work by
/// itself, and temporary files are removed when they are dropped.
pub fn leave_signals() {
    IS_GUEST.store(true, Ordering::SeqCst);
}

/// Starts the thread that waits for signals, and makes a file that is too large an error of the
/// write. Without it a signal ends the program as usual.
pub fn watch() {
    static WATCH: Once = Once::new();
    if IS_GUEST.load(Ordering::SeqCst) {
        return;
    }
    WATCH.call_once(|| {
        // A file that grows beyond a limit is then an error of the write, not the end.
        let _ = register(SIGXFSZ, Arc::new(AtomicBool::new(false)));
        let ignored = ignored();
        let wanted = [SIGINT, SIGTERM].into_iter();
        let Ok(mut signals) =
            Signals::new(wanted.filter(|signal| ignored >> (signal - 1) & 1 == 0))
        else {
            return;
        };
        std::thread::spawn(move || {
            let mut is_first = true;
            for signal in signals.forever() {
                let is_orderly = IS_ORDERLY.load(Ordering::SeqCst);
                if is_orderly && std::mem::take(&mut is_first) {
                    continue;
                }
                // Held to the end: nothing more is made.
                let mut paths = paths();
                for path in std::mem::take(&mut *paths) {
                    let _ = fs::remove_file(&path).or_else(|_| fs::remove_dir_all(&path));
                }
                if let Some(work) = LAST_WORK.get() {
                    work();
                }
                if is_orderly {
                    // Shells report 128 + signal for a program that a signal ended.
                    std::process::exit(128 + signal);
                }
                let _ = emulate_default_handler(signal);
            }
        });
    });
}

/// Returns the signals that the program ignores from its start, such as SIGINT of a job in the
/// background, as a mask.
fn ignored() -> u64 {
    let status = fs::read_to_string("/proc/self/status").unwrap_or_default();
    let mask = status.lines().find_map(|line| line.strip_prefix("SigIgn:"));
    mask.and_then(|mask| u64::from_str_radix(mask.trim(), 16).ok())
        .unwrap_or(0)
}
