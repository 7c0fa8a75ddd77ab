//! Whether overrun hides brakes that no signal reports.
//!
//! The smoothed force decides. The likelihoods of the two hypotheses are nearly the same: a step of the
//! bias explains a constant retarder almost as well.

use crate::cell::CELL_LENGTH_M;
use crate::filter::{Adjoint, CellInput, Quantity, Record};
use crate::scalar::Scalar;

/// Force beyond which a brake is hidden, %, at a distance of four sigmas.
const LEAST_PERCENT: f32 = 1.0;
const SIGMAS: f32 = 4.0;
/// Distance over which brakes must have been hidden for the bus to count as one without them, m.
const LEAST_M: f32 = 20.0;

/// The cells so far in which a brake was hidden, under the hypothesis that overrun is doubtful.
#[derive(Clone, Copy, Debug)]
pub struct HiddenBrakes {
    cells: usize,
}

impl HiddenBrakes {
    /// None so far.
    pub const NONE: Self = Self { cells: 0 };

    /// Returns whether a brake could be hidden in a cell.
    #[must_use]
    pub const fn could_be_in(cell: &CellInput) -> bool {
        cell.marks.overrun && !cell.marks.invalid
    }

    /// Takes a cell with its record and what later cells say.
    pub fn take<S: Scalar>(&mut self, cell: &CellInput, record: &Record<S>, later: &Adjoint<S>) {
        if Self::could_be_in(cell) {
            let force = later.smooth(&record.state, Quantity::DoubtfulForce);
            let force = force.to_single();
            let least = force.mean - SIGMAS * Scalar::sqrt(force.variance);
            self.cells += usize::from(least > LEAST_PERCENT);
        }
    }

    /// Returns whether brakes act that no signal reports.
    #[must_use]
    pub fn are_found(&self) -> bool {
        self.cells as f32 * CELL_LENGTH_M > LEAST_M
    }
}
