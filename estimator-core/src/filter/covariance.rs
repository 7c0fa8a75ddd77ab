//! A symmetric matrix of the filter's size, upper triangle by rows.

use super::state::STATES;
use crate::scalar::Scalar;
use nalgebra::{SMatrix, SVector};

/// Numbers in the upper triangle.
const PACKED: usize = STATES * (STATES + 1) / 2;

/// A covariance (or, in the backward pass, an information matrix).
///
/// Only one triangle exists, so it is symmetric by construction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Covariance<S> {
    upper: [S; PACKED],
}

/// Place of (i, j) in the packed triangle.
const fn at(i: usize, j: usize) -> usize {
    let (low, high) = if i < j { (i, j) } else { (j, i) };
    low * STATES - low * (low + 1) / 2 + high
}

impl<S: Scalar> Covariance<S> {
    /// All zero.
    pub const ZERO: Self = Self {
        upper: [S::ZERO; PACKED],
    };

    /// Element (i, j).
    #[inline(always)]
    #[must_use]
    pub fn get(&self, i: usize, j: usize) -> S {
        // Not by `[]`: a controller's image has no panics, not even where the compiler does not
        // see that there is such an element.
        self.upper.get(at(i, j)).copied().unwrap_or(S::ZERO)
    }

    /// Sets the elements (i, j) and (j, i).
    #[inline(always)]
    pub fn set(&mut self, i: usize, j: usize, value: S) {
        if let Some(element) = self.upper.get_mut(at(i, j)) {
            *element = value;
        }
    }

    /// Adds to the variance of state `i`.
    #[inline(always)]
    pub fn add_variance(&mut self, i: usize, variance: S) {
        self.set(i, i, self.get(i, i) + variance);
    }

    /// Row (and column) `i`.
    #[inline(always)]
    #[must_use]
    pub fn row(&self, i: usize) -> [S; STATES] {
        let mut row = [S::ZERO; STATES];
        for (k, element) in row.iter_mut().enumerate() {
            *element = self.get(i, k);
        }
        row
    }

    /// Row and column `i` all zero: the state is no longer tied to the others.
    #[inline(always)]
    pub fn clear(&mut self, i: usize) {
        for k in 0..STATES {
            self.set(i, k, S::ZERO);
        }
    }

    /// `x_i += factor * x_j`: row and column.
    #[inline(always)]
    pub fn shear(&mut self, i: usize, j: usize, factor: S) {
        let variance =
            self.get(i, i) + factor * (self.get(i, j) + self.get(i, j) + factor * self.get(j, j));
        for k in 0..STATES {
            if k != i {
                let mut sheared = self.get(i, k);
                sheared.add_product(factor, &self.get(j, k));
                self.set(i, k, sheared);
            }
        }
        self.set(i, i, variance);
    }

    /// `x_i += factor * h x`, with the cross covariance P h' and the variance h P h': row and
    /// column.
    #[inline(always)]
    pub fn shear_by(&mut self, i: usize, factor: S, cross: &[S; STATES], variance: S) {
        let variance = self.get(i, i) + factor * (cross[i] + cross[i] + factor * variance);
        for (k, cross) in cross.iter().enumerate() {
            if k != i {
                let mut sheared = self.get(i, k);
                sheared.add_product(factor, cross);
                self.set(i, k, sheared);
            }
        }
        self.set(i, i, variance);
    }

    /// `x_i *= factor`: row and column.
    #[inline(always)]
    pub fn scale(&mut self, i: usize, factor: S) {
        for k in 0..STATES {
            let scaled = self.get(i, k) * factor;
            self.set(i, k, scaled);
        }
        let variance = self.get(i, i) * factor;
        self.set(i, i, variance);
    }

    /// `P - K b'` for the gain K = b / s: a scalar update.
    ///
    /// Joseph's form costs half as much again and guards a gain that is not quite right; here the
    /// gain is b / s to a rounding, and tests hold single precision against double.
    #[inline(always)]
    pub fn reduce(&mut self, gain: &[S; STATES], cross: &[S; STATES]) {
        let mut upper = self.upper.as_mut_slice();
        let mut crosses = cross.as_slice();
        for gain in gain {
            let Some((row, later)) = upper.split_at_mut_checked(crosses.len()) else {
                return;
            };
            S::add_products(row, -*gain, crosses);
            upper = later;
            crosses = crosses.get(1..).unwrap_or_default();
        }
    }

    /// `M + A N A'`, with A given by its columns.
    #[must_use]
    pub fn plus_congruence(&self, columns: &[[S; STATES]; STATES], other: &Self) -> Self {
        // A N, by columns.
        let mut product = [[S::ZERO; STATES]; STATES];
        for (column, factors) in product.iter_mut().zip(&other.rows()) {
            for (factor, of_a) in factors.iter().zip(columns) {
                S::add_products(column, *factor, of_a);
            }
        }
        let mut sum = *self;
        let mut elements = sum.upper.iter_mut();
        for i in 0..STATES {
            for (j, element) in (i..STATES).zip(&mut elements) {
                for (of_product, of_a) in product.iter().zip(columns) {
                    element.add_product(of_product[i], &of_a[j]);
                }
            }
        }
        sum
    }

    /// All rows.
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

    /// `M v`.
    #[inline(never)] // Long: every element is written out.
    #[must_use]
    pub fn times(&self, vector: &[S; STATES]) -> [S; STATES] {
        let mut product = [S::ZERO; STATES];
        self.add_times::<0>(vector, &mut product);
        self.add_times::<1>(vector, &mut product);
        self.add_times::<2>(vector, &mut product);
        self.add_times::<3>(vector, &mut product);
        self.add_times::<4>(vector, &mut product);
        self.add_times::<5>(vector, &mut product);
        self.add_times::<6>(vector, &mut product);
        self.add_times::<7>(vector, &mut product);
        product
    }

    /// What the part of row and column I from the diagonal on adds to the product.
    #[inline(always)]
    fn add_times<const I: usize>(&self, vector: &[S; STATES], product: &mut [S; STATES]) {
        product[I].add_product(self.get(I, I), &vector[I]);
        for j in I + 1..STATES {
            let element = self.get(I, j);
            product[I].add_product(element, &vector[j]);
            product[j].add_product(element, &vector[I]);
        }
    }

    /// Whether every variance is a finite number, and none negative. What lies beyond the
    /// diagonal cannot be infinite then: |p_ij|² is at most p_ii p_jj.
    #[inline]
    #[must_use]
    pub fn is_sound(&self) -> bool {
        let mut variances = [S::ZERO; STATES];
        for (i, variance) in variances.iter_mut().enumerate() {
            *variance = self.get(i, i);
        }
        S::are_positive(&variances) && S::are_finite(&variances)
    }

    /// As a full matrix.
    #[must_use]
    pub fn to_matrix(&self) -> SMatrix<f64, STATES, STATES> {
        SMatrix::from_fn(|i, j| self.get(i, j).to_f64())
    }

    /// In another number.
    #[must_use]
    pub fn cast<T: Scalar>(&self) -> Covariance<T> {
        Covariance {
            upper: self.upper.map(|element| T::from_f64(element.to_f64())),
        }
    }
}

/// A state as a nalgebra vector, for reference computations.
#[must_use]
pub fn to_vector<S: Scalar>(x: &[S; STATES]) -> SVector<f64, STATES> {
    SVector::from_fn(|i, _| x[i].to_f64())
}
