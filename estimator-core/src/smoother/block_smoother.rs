//! The backward pass over a block of steps, for any information that comes after it.

use super::backward_pass::BackwardPass;
use crate::filter::{QuantityEstimate, STATES, SmootherInput, StateVector};
use crate::scalar::Scalar;

/// The backward pass over a block: λ ← λ₀ + Ψ λ and Λ ← Λ₀ + Ψ Λ Ψ'.
///
/// With it a fixed lag goes back over each step once, and over whole blocks from then on.
#[derive(Clone, Copy, Debug)]
pub struct BlockSmoother<S> {
    /// λ₀ and Λ₀: what the steps themselves say.
    within: BackwardPass<S>,
    /// Columns of Ψ: the images of the unit vectors.
    columns: [StateVector<S>; STATES],
}

impl<S: Scalar> BlockSmoother<S> {
    /// Creates the pass over an empty block.
    #[must_use]
    pub fn new() -> Self {
        let mut columns = [StateVector::ZERO; STATES];
        for (i, column) in columns.iter_mut().enumerate() {
            column.0[i] = S::ONE;
        }
        Self {
            within: BackwardPass::new(),
            columns,
        }
    }

    /// Goes back over one more step.
    pub fn retreat(&mut self, step: &SmootherInput<S>) {
        self.within.retreat(step);
        for column in &mut self.columns {
            step.transpose_scale(column);
            for (observation, update) in step.updates() {
                update.transpose_vector(observation, step.dynamics.net_traction, column);
            }
            step.transpose_prediction(column);
        }
    }

    /// Returns the backward pass over the block alone, with nothing after it.
    #[must_use]
    pub const fn within(&self) -> &BackwardPass<S> {
        &self.within
    }

    /// Returns the estimate of a quantity before the block, smoothed by the block. Its covariance is
    /// with the states at the end of the block, not with those before it.
    #[must_use]
    pub fn smooth(&self, filtered: &QuantityEstimate<S>) -> QuantityEstimate<S> {
        let mut cross = StateVector::ZERO;
        for (element, column) in cross.0.iter_mut().zip(&self.columns) {
            *element = filtered.cross.dot(column);
        }
        QuantityEstimate {
            cross,
            ..self.within.smooth(filtered)
        }
    }

    /// Takes a backward pass from the end of the block to its start.
    pub fn retreat_through(&self, pass: &mut BackwardPass<S>) {
        let mut lambda = self.within.lambda;
        for (factor, column) in pass.lambda.0.iter().zip(&self.columns) {
            for (element, of_column) in lambda.0.iter_mut().zip(&column.0) {
                element.add_product(*factor, of_column);
            }
        }
        pass.lambda = lambda;
        pass.information = self
            .within
            .information
            .plus_congruence(&self.columns, &pass.information);
    }
}

impl<S: Scalar> Default for BlockSmoother<S> {
    fn default() -> Self {
        Self::new()
    }
}
