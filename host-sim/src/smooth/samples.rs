//! The samples of a run, wherever they are.

use estimator_core::sample::Sample;
use std::convert::Infallible;
use std::ops::Range;

/// Samples that can be gone over more than once.
pub trait Samples {
    /// What can go wrong on the way.
    type Error;

    /// How many there are.
    fn count(&self) -> usize;

    /// Passes those of a part to `take`, in the order of the run.
    ///
    /// # Errors
    /// If they cannot be had.
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
