//! The estimator whose instructions are counted, and why nothing was counted.

use crate::meter::Uncountable;
use crate::recorded::Unusable;
use core::mem::MaybeUninit;
use embedded_storage::nor_flash::NorFlashErrorKind;
use estimator_core::roadmap::MapError;
use estimator_core::roadmap::memory::MemoryError;
use estimator_core::{Estimator, Model, ParameterError, Scalar, Tuning};

/// Why nothing was counted.
#[derive(Debug)]
pub enum BudgetError {
    /// The drive cannot be used.
    Drive(Unusable),
    /// Instructions cannot be counted.
    Count(Uncountable),
    /// There is no usable map in flash.
    Map(MapError),
    /// The road memory fails.
    Memory(MemoryError<NorFlashErrorKind>),
}

impl From<Uncountable> for BudgetError {
    fn from(uncountable: Uncountable) -> Self {
        Self::Count(uncountable)
    }
}

impl From<Unusable> for BudgetError {
    fn from(unusable: Unusable) -> Self {
        Self::Drive(unusable)
    }
}

/// Returns the tuning of the counts: the drive is too short to leave a state without it.
pub(crate) fn tuning() -> Tuning {
    let mut tuning = Tuning::default();
    tuning.detection.persist_cells = 100;
    tuning
}

/// Creates the estimator in its place. Not inlined, so that all of the stack counts that it needs.
#[inline(never)]
pub(crate) fn create<'a, S: Scalar>(
    place: &'a mut MaybeUninit<Estimator<S>>,
    model: &Model,
) -> Result<&'a mut Estimator<S>, ParameterError> {
    Estimator::new_in(place, model, &tuning())
}
