//! The row h of a measurement.

use crate::filter::covariance::{Covariance, StateVector};
use crate::filter::state_index::{STATES, StateIndex};
use crate::scalar::Scalar;

/// The states that a measurement sees, and how much of each.
pub struct Row<S, const N: usize>(pub [(StateIndex, S); N]);

impl<S: Scalar, const N: usize> Row<S, N> {
    /// Returns h v.
    #[inline(always)]
    pub fn of(&self, v: &StateVector<S>) -> S {
        let parts = self.0.iter().map(|&(i, h)| h * v[i as usize]);
        parts.reduce(|sum, part| sum + part).unwrap_or(S::ZERO)
    }

    /// Returns P h'.
    #[inline(always)]
    pub fn cross(&self, p: &Covariance<S>) -> StateVector<S> {
        cross(&self.0, p)
    }
}

#[inline(never)] // One copy: flash is small.
fn cross<S: Scalar>(row: &[(StateIndex, S)], p: &Covariance<S>) -> StateVector<S> {
    let mut cross = [S::ZERO; STATES];
    for &(i, h) in row.iter().rev() {
        S::add_products(&mut cross, h, &p.row(i));
    }
    cross
}
