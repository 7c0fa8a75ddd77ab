//! A symmetric matrix of the filter's size: its upper triangle, by rows.

use super::state_index::{STATES, StateIndex, StateVector, for_each_state};
use crate::scalar::Scalar;
use nalgebra::SMatrix;

/// Number of elements of the upper triangle.
const PACKED: usize = STATES * (STATES + 1) / 2;

/// A covariance matrix, or in the backward pass an information matrix.
///
/// It stores one triangle, so it is symmetric by construction. [`to_nalgebra`](Self::to_nalgebra)
/// gives the dense form, which the tests use as the reference for every operation here.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Covariance<S> {
    upper: [S; PACKED],
}

/// Returns the position of element (i, j) in the packed triangle.
#[inline] // In other crates, whatever they optimize.
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

    /// Sets the elements (i, j) and (j, i).
    #[inline(always)]
    pub fn set(&mut self, i: StateIndex, j: StateIndex, value: S) {
        self.set_element(i as usize, j as usize, value);
    }

    /// Returns the variance of a state.
    #[inline(always)]
    #[must_use]
    pub fn variance(&self, i: StateIndex) -> S {
        self.get(i, i)
    }

    /// Adds to the variance of a state.
    #[inline(always)]
    pub fn add_variance(&mut self, i: StateIndex, variance: S) {
        self.set(i, i, self.get(i, i) + variance);
    }

    /// Returns row (and column) `i`.
    #[inline(always)]
    #[must_use]
    pub fn row(&self, i: StateIndex) -> StateVector<S> {
        let mut row = StateVector::ZERO;
        for (k, element) in row.0.iter_mut().enumerate() {
            *element = self.element(i as usize, k);
        }
        row
    }

    /// Sets row and column `i` to zero: the state is no longer correlated with the others.
    #[inline(always)]
    pub fn clear(&mut self, i: StateIndex) {
        for k in 0..STATES {
            self.set_element(i as usize, k, S::ZERO);
        }
    }

    /// Sets the rows and columns to zero of the states that a gap ends.
    #[inline(always)]
    pub(crate) fn clear_after_gap(&mut self) {
        macro_rules! clear {
            ($index:tt) => {
                if !StateIndex::ALL[$index].survives_gap() {
                    self.clear(StateIndex::ALL[$index]);
                }
            };
        }
        for_each_state!(clear);
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

    /// Applies the shear `x_i += factor * h x` to rows and columns, given the cross covariance P h'
    /// and the variance h P h'.
    #[inline(always)]
    pub fn shear_by(&mut self, i: StateIndex, factor: S, cross: &StateVector<S>, variance: S) {
        let variance = self.get(i, i) + factor * (cross[i] + cross[i] + factor * variance);
        let i = i as usize;
        for (k, cross) in cross.0.iter().enumerate() {
            if k != i {
                let mut sheared = self.element(i, k);
                sheared.add_product(factor, cross);
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
    ///
    /// Joseph's form costs half as much again and guards against a gain that is not optimal. The
    /// gain here is b / s up to rounding, and tests hold single precision against double.
    #[inline(always)]
    pub fn reduce(&mut self, gain: &StateVector<S>, cross: &StateVector<S>) {
        let mut upper = self.upper.as_mut_slice();
        let mut crosses = cross.0.as_slice();
        for gain in &gain.0 {
            let Some((row, later)) = upper.split_at_mut_checked(crosses.len()) else {
                return;
            };
            S::add_products(row, -*gain, crosses);
            upper = later;
            crosses = crosses.get(1..).unwrap_or_default();
        }
    }

    /// Returns `M + A N A'`, with A given by its columns.
    #[must_use]
    pub fn plus_congruence(&self, columns: &[StateVector<S>; STATES], other: &Self) -> Self {
        // A N, by columns.
        let mut product = [StateVector::ZERO; STATES];
        for (column, factors) in product.iter_mut().zip(&other.rows()) {
            for (factor, of_a) in factors.iter().zip(columns) {
                S::add_products(&mut column.0, *factor, &of_a.0);
            }
        }
        let mut sum = *self;
        let mut elements = sum.upper.iter_mut();
        for i in 0..STATES {
            for (j, element) in (i..STATES).zip(&mut elements) {
                for (of_product, of_a) in product.iter().zip(columns) {
                    element.add_product(of_product.0[i], &of_a.0[j]);
                }
            }
        }
        sum
    }

    /// Returns `M v`.
    #[inline(never)] // Long: every element is written out.
    #[must_use]
    pub fn times(&self, vector: &StateVector<S>) -> StateVector<S> {
        let mut product = StateVector::ZERO;
        macro_rules! add_row {
            ($index:tt) => {
                self.add_times::<$index>(&vector.0, &mut product.0)
            };
        }
        for_each_state!(add_row);
        product
    }

    /// Adds to the product what the part of row and column I from the diagonal on contributes.
    #[inline(always)]
    fn add_times<const I: usize>(&self, vector: &[S; STATES], product: &mut [S; STATES]) {
        product[I].add_product(self.element(I, I), &vector[I]);
        for j in I + 1..STATES {
            let element = self.element(I, j);
            product[I].add_product(element, &vector[j]);
            product[j].add_product(element, &vector[I]);
        }
    }

    /// Returns whether every variance is finite and not negative. The other elements are finite
    /// then: |p_ij|² is at most p_ii p_jj.
    #[inline]
    #[must_use]
    pub fn is_sound(&self) -> bool {
        let mut variances = [S::ZERO; STATES];
        for (i, variance) in variances.iter_mut().enumerate() {
            *variance = self.element(i, i);
        }
        S::are_positive(&variances) && S::are_finite(&variances)
    }

    /// Returns the full matrix in nalgebra's type.
    #[must_use]
    pub fn to_nalgebra(&self) -> SMatrix<S, STATES, STATES>
    where
        S: nalgebra::Scalar,
    {
        SMatrix::from_fn(|i, j| self.element(i, j))
    }

    /// Returns the matrix in another number type.
    #[must_use]
    pub fn cast<T: Scalar>(&self) -> Covariance<T> {
        Covariance {
            upper: self.upper.map(|element| T::from_f64(element.to_f64())),
        }
    }

    // Elements by number, for loops over all states. Not by `[]`: an image must not contain a
    // panic, even where the compiler cannot prove an index.

    #[inline(always)]
    pub(super) fn element(&self, i: usize, j: usize) -> S {
        self.upper
            .get(packed_index(i, j))
            .copied()
            .unwrap_or(S::ZERO)
    }

    #[inline(always)]
    fn set_element(&mut self, i: usize, j: usize, value: S) {
        if let Some(element) = self.upper.get_mut(packed_index(i, j)) {
            *element = value;
        }
    }

    #[inline(always)]
    pub(super) fn set_row(&mut self, i: StateIndex, row: impl Fn(usize) -> S) {
        for k in 0..STATES {
            self.set_element(i as usize, k, row(k));
        }
    }

    /// Adds `f h' h - h' b - b' h`, where h sums the states `seen`. Only their rows and columns
    /// change.
    #[inline(always)]
    pub(super) fn add_observation_products<const SEEN: usize>(
        &mut self,
        seen: [StateIndex; SEEN],
        b: &StateVector<S>,
        factor: S,
    ) {
        let seen = seen.map(|state| state as usize);
        let at = |i: usize| b.0.get(i).copied().unwrap_or(S::ZERO);
        for (n, i) in seen.into_iter().enumerate() {
            for (k, element) in b.0.iter().enumerate() {
                if !seen.contains(&k) {
                    self.set_element(i, k, self.element(i, k) - *element);
                }
            }
            for j in seen.into_iter().skip(n) {
                self.set_element(i, j, self.element(i, j) + (factor - at(j) - at(i)));
            }
        }
    }

    /// Adds `f h' h - h' b - b' h` for a row h of any numbers.
    #[inline(never)] // Rare.
    pub(super) fn add_row_products(&mut self, row: &StateVector<S>, b: &StateVector<S>, factor: S) {
        for (i, (row_i, b_i)) in row.0.iter().zip(&b.0).enumerate() {
            for (j, (row_j, b_j)) in row.0.iter().zip(&b.0).enumerate().skip(i) {
                let change = *row_i * (factor * *row_j - *b_j) - *b_i * *row_j;
                self.set_element(i, j, self.element(i, j) + change);
            }
        }
    }

    /// Returns all rows.
    #[allow(
        clippy::needless_range_loop,
        reason = "each element goes to a row and a column"
    )]
    fn rows(&self) -> [[S; STATES]; STATES] {
        let mut rows = [[S::ZERO; STATES]; STATES];
        let mut elements = self.upper.iter();
        for i in 0..STATES {
            for (j, element) in (i..STATES).zip(&mut elements) {
                rows[i][j] = *element;
                rows[j][i] = *element;
            }
        }
        rows
    }
}
