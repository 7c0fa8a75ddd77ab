//! The samples of a run, in memory or on disk.

use estimator_core::sample::Sample;
use std::convert::Infallible;
use std::ops::Range;

/// Samples that can be read more than once.
pub trait Samples {
    /// Error of reading.
    type Error;

    /// Returns the number of samples.
    fn count(&self) -> usize;

    /// Passes the samples of a range to `take`, in the order of the run.
    ///
    /// # Errors
    /// Returns an error if the samples cannot be read.
    fn each(&mut self, part: Range<usize>, take: impl FnMut(&Sample)) -> Result<(), Self::Error>;
}

impl Samples for &[Sample] {
    type Error = Infallible;

    fn count(&self) -> usize {
        self.len()
    }

    fn each(&mut self, part: Range<usize>, take: impl FnMut(&Sample)) -> Result<(), Infallible> {
        self[part].iter().for_each(take);
        Ok(())
    }
}
