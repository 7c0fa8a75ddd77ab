//! A symmetric matrix of the filter's size: its upper triangle, by rows.

use super::state_index::{STATES, StateIndex};
use crate::scalar::Scalar;

/// Number of elements of the upper triangle.
const PACKED: usize = STATES * (STATES + 1) / 2;

/// A vector of the filter's size.
pub type StateVector<S> = [S; STATES];

/// A covariance matrix, or in the backward pass an information matrix. It stores one triangle, so
/// it is symmetric by construction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Covariance<S> {
    upper: [S; PACKED],
}

#[inline(always)]
const fn packed_index(i: usize, j: usize) -> usize {
    let (low, high) = if i < j { (i, j) } else { (j, i) };
    low * STATES - low * (low + 1) / 2 + high
}

impl<S: Scalar> Covariance<S> {
    /// The zero matrix.
    pub const ZERO: Self = Self {
        upper: [S::ZERO; PACKED],
    };

    /// Returns element (i, j).
    #[inline(always)]
    #[must_use]
    pub fn get(&self, i: StateIndex, j: StateIndex) -> S {
        self.element(i as usize, j as usize)
    }

    /// Adds to the elements (i, j) and (j, i).
    #[inline(always)]
    pub fn add(&mut self, i: StateIndex, j: StateIndex, value: S) {
        let sum = self.get(i, j) + value;
        self.set_element(i as usize, j as usize, sum);
    }

    /// Returns row (and column) `i`.
    #[inline(always)]
    #[must_use]
    pub fn row(&self, i: StateIndex) -> StateVector<S> {
        let mut row = [S::ZERO; STATES];
        for (k, element) in row.iter_mut().enumerate() {
            *element = self.element(i as usize, k);
        }
        row
    }

    /// Sets row and column `i` to zero.
    #[inline(always)]
    pub fn clear(&mut self, i: StateIndex) {
        for k in 0..STATES {
            self.set_element(i as usize, k, S::ZERO);
        }
    }

    /// Applies the shear `x_i += factor * x_j` to rows and columns.
    #[inline(always)]
    pub fn shear(&mut self, i: StateIndex, j: StateIndex, factor: S) {
        let (i, j) = (i as usize, j as usize);
        let variance = self.element(i, i)
            + factor * (self.element(i, j) + self.element(i, j) + factor * self.element(j, j));
        for k in 0..STATES {
            if k != i {
                let mut sheared = self.element(i, k);
                sheared.add_product(factor, &self.element(j, k));
                self.set_element(i, k, sheared);
            }
        }
        self.set_element(i, i, variance);
    }

    /// Applies `x_i *= factor` to row and column.
    #[inline(always)]
    pub fn scale(&mut self, i: StateIndex, factor: S) {
        let i = i as usize;
        for k in 0..STATES {
            let scaled = self.element(i, k) * factor;
            self.set_element(i, k, scaled);
        }
        let variance = self.element(i, i) * factor;
        self.set_element(i, i, variance);
    }

    /// Computes `P - K b'` for the gain K = b / s: the covariance after a scalar update.
    #[inline(always)]
    pub fn reduce(&mut self, gain: &StateVector<S>, cross: &StateVector<S>) {
        let mut upper = self.upper.iter_mut();
        for (i, gain) in gain.iter().enumerate() {
            // The row first, so that the triangle is not asked for more than the row has.
            for (cross, element) in cross.iter().skip(i).zip(&mut upper) {
                element.add_product(-*gain, cross);
            }
        }
    }

    /// Computes `M + q v v'`.
    pub fn add_square(&mut self, q: S, v: &StateVector<S>) {
        let mut upper = self.upper.iter_mut();
        for (i, factor) in v.iter().enumerate() {
            for (other, element) in v.iter().skip(i).zip(&mut upper) {
                element.add_product(q * *factor, other);
            }
        }
    }

    /// Computes `M - h' b - b' h` for the row h that is `h` at `i` and zero elsewhere.
    #[inline(always)]
    pub fn subtract_cross(&mut self, i: StateIndex, h: S, b: &StateVector<S>) {
        for (k, index) in StateIndex::ALL.into_iter().enumerate() {
            self.add(i, index, -(h * b[k]));
        }
        self.add(i, i, -(h * b[i as usize]));
    }

    /// Returns `M v`.
    #[inline(never)] // One copy: flash is small.
    #[must_use]
    pub fn times(&self, vector: &StateVector<S>) -> StateVector<S> {
        let mut product = [S::ZERO; STATES];
        let mut upper = self.upper.iter();
        for i in 0..STATES {
            for (j, element) in (i..STATES).zip(&mut upper) {
                product[i].add_product(*element, &vector[j]);
                if j > i {
                    product[j].add_product(*element, &vector[i]);
                }
            }
        }
        product
    }

    /// Returns whether every variance is finite and not negative.
    #[inline(never)] // One copy: flash is small.
    #[must_use]
    pub fn is_sound(&self) -> bool {
        (0..STATES).all(|i| {
            let variance = self.element(i, i);
            variance.is_finite() && variance >= S::ZERO
        })
    }

    #[inline(always)]
    fn element(&self, i: usize, j: usize) -> S {
        // Without a check that may panic.
        let element = self.upper.get(packed_index(i, j));
        element.copied().unwrap_or(S::ZERO)
    }

    #[inline(always)]
    fn set_element(&mut self, i: usize, j: usize, value: S) {
        if let Some(element) = self.upper.get_mut(packed_index(i, j)) {
            *element = value;
        }
    }
}
