//! A request to stop long work.

use crate::error::{Error, Result};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// A flag by which another thread stops long work. It is not set at first.
#[derive(Clone, Debug, Default)]
pub struct Stop(Arc<AtomicBool>);

impl Stop {
    /// Asks the work to stop. It does so at its next [`check`](Self::check).
    pub fn request(&self) {
        self.0.store(true, Ordering::Relaxed);
    }

    /// Checks whether the work may go on.
    ///
    /// # Errors
    /// Returns [`Error::Stopped`] if it was asked to stop.
    pub fn check(&self) -> Result<()> {
        if self.0.load(Ordering::Relaxed) {
            return Err(Error::Stopped);
        }
        Ok(())
    }
}

impl PartialEq for Stop {
    /// Compares the flags, not the threads that hold them.
    fn eq(&self, other: &Self) -> bool {
        self.check().is_ok() == other.check().is_ok()
    }
}
