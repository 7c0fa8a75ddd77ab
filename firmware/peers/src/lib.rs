//! The same work for every filter: predict, and take in two scalar measurements.
//!
//! The model is linear and given as dense matrices that the compiler knows nothing of: speed,
//! altitude and slope, and as many slow states as there are more, which all add to the slope; speed
//! and altitude are measured every 50 ms. Peers take both measurements in one update, which is
//! the cheapest that they offer. All run for the same thousand steps and report where they end:
//! they must agree.
//!
//! An image holds one filter and prints words, not text, so that what it adds to the image that
//! holds none is its own.

#![no_std]
#![warn(missing_docs)]

pub mod dense;
pub mod minikalman_filter;
pub mod ours;

use core::hint::black_box;
use firmware::meter::{Meter, Tally, Uncountable, depth};
use semihosting::io::{self, Write};

/// Time between steps, s.
const STEP_S: f32 = 0.05;
const STEPS: u32 = 1_000;

/// The matrices by rows.
#[derive(Clone, Copy, Debug)]
pub struct Model<const N: usize> {
    /// F, the transition.
    pub transition: [[f32; N]; N],
    /// Q, the noise of a step.
    pub step_noise: [[f32; N]; N],
    /// H, what is measured.
    pub measured: [[f32; N]; 2],
    /// R, the noise of the measurements.
    pub noise: [[f32; 2]; 2],
    /// P, at the start.
    pub covariance: [[f32; N]; N],
}

impl<const N: usize> Model<N> {
    /// The model of every filter here.
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
            transition[slow][slow] = 1.0 - 0.01 * slow as f32;
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

impl<const N: usize> Default for Model<N> {
    fn default() -> Self {
        Self::new()
    }
}

fn diagonal<const N: usize>(elements: [f32; N]) -> [[f32; N]; N] {
    let mut matrix = [[0.0; N]; N];
    for (i, element) in elements.into_iter().enumerate() {
        matrix[i][i] = element;
    }
    matrix
}

/// Speed and altitude at a step, with something like noise.
fn measurements(step: u32) -> [f32; 2] {
    let noise = |factor: u32, size: f32| (((step * factor) % 23) as f32 - 11.0) * size;
    black_box([20.0 + noise(7, 0.01), 100.0 + noise(5, 0.2)])
}

/// Counts a filter of this size (bytes) that is moved a step by two measurements and says where
/// it is, and prints: instructions (mean and worst), bytes of stack and of the filter, the state.
pub fn report<const N: usize>(bytes: usize, mut step: impl FnMut([f32; 2]) -> [f32; N]) {
    let _ = count(bytes, &mut step);
}

fn count<const N: usize>(
    bytes: usize,
    step: &mut impl FnMut([f32; 2]) -> [f32; N],
) -> Result<(), Uncountable> {
    let mut meter = Meter::new()?;
    let mut tally = Tally::default();
    let mut deepest = 0;
    let mut state = [0.0; N];
    for number in 0..STEPS {
        let measured = measurements(number);
        let (now, instructions) = meter.count(|| step(measured))?;
        tally.add(instructions);
        state = now;
    }
    for number in 0..3 {
        let measured = measurements(number);
        deepest = deepest.max(depth(|| step(measured)).1);
    }
    for word in [tally.mean(), tally.worst(), deepest as u32, bytes as u32]
        .into_iter()
        .chain(state.map(f32::to_bits))
    {
        print(word);
    }
    Ok(())
}

/// Nothing is printed where nothing can be: the host misses it.
fn print(word: u32) {
    if let Ok(mut stdout) = io::stdout() {
        let _ = stdout.write_all(&word.to_le_bytes());
    }
}

/// An image of one filter: `main`, from an expression that reports it.
#[macro_export]
macro_rules! image {
    ($report:expr) => {
        #[cortex_m_rt::entry]
        fn main() -> ! {
            $report;
            semihosting::process::exit(0)
        }

        #[panic_handler]
        fn panicked(_: &core::panic::PanicInfo<'_>) -> ! {
            semihosting::process::exit(101)
        }
    };
}
