//! The dense model and the measurements of all filters.

use super::Real;
use core::hint::black_box;

/// Measures a filter.
pub trait FilterMeter {
    /// Measures a filter of this size (bytes). `step` takes two measurements and returns the state.
    fn measure<const N: usize>(&mut self, bytes: usize, step: impl FnMut([Real; 2]) -> [Real; N]);
}

/// Time between steps, s.
const STEP_S: Real = 0.05;

/// The matrices, by rows.
#[derive(Clone, Copy, Debug)]
pub struct LinearModel<const N: usize> {
    /// F, the transition.
    pub transition: [[Real; N]; N],
    /// Q, the process noise of a step.
    pub step_noise: [[Real; N]; N],
    /// H, the measurement matrix.
    pub measured: [[Real; N]; 2],
    /// R, the measurement noise.
    pub noise: [[Real; 2]; 2],
    /// P at the start.
    pub covariance: [[Real; N]; N],
}

impl<const N: usize> LinearModel<N> {
    /// Creates the model that all filters here use.
    #[must_use]
    pub fn new() -> Self {
        let one = diagonal([1.0; N]);
        let mut transition = one;
        let mut step_noise = [0.0; N];
        // m/s for a slope of 1, and m for a slope of 1 at 20 m/s.
        transition[0][2] = -9.81 * STEP_S;
        transition[1][2] = 20.0 * STEP_S;
        step_noise[..3].copy_from_slice(&[1e-3, 1e-4, 1e-6]);
        for slow in 3..N {
            transition[2][slow] = STEP_S;
            transition[slow][slow] = 1.0 - 0.01 * slow as Real;
            step_noise[slow] = 1e-6;
        }
        let mut measured = [[0.0; N]; 2];
        measured[0][0] = 1.0;
        measured[1][1] = 1.0;
        black_box(Self {
            transition,
            step_noise: diagonal(step_noise),
            measured,
            noise: diagonal([0.01, 4.0]),
            covariance: one,
        })
    }
}

impl<const N: usize> Default for LinearModel<N> {
    fn default() -> Self {
        Self::new()
    }
}

fn diagonal<const N: usize>(elements: [Real; N]) -> [[Real; N]; N] {
    let mut matrix = [[0.0; N]; N];
    for (i, element) in elements.into_iter().enumerate() {
        matrix[i][i] = element;
    }
    matrix
}

/// Returns speed and altitude at a step, with pseudo-noise.
#[must_use]
pub fn measurements(step: u32) -> [Real; 2] {
    let noise = |factor: u32, size: Real| (((step * factor) % 23) as Real - 11.0) * size;
    black_box([20.0 + noise(7, 0.01), 100.0 + noise(5, 0.2)])
}
