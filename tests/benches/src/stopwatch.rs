//! Times one filter. Its state after a thousand steps shows that it did the work.

use crate::{double, single};
use std::hint::black_box;
use std::time::Instant;

/// Steps before the timed ones. After them all filters of a size must agree.
const WARM_UP: u32 = 1_000;
/// Number of timed steps. On a constant road some covariances decay until they are denormal, after
/// 40,000 steps in single precision. Processors then take twice as long, so there are fewer steps.
pub const STEPS: u32 = 10_000;

/// Measures the time of a step.
#[derive(Debug)]
pub struct Stopwatch {
    steps: u32,
    /// Time of a step, ns.
    pub step_ns: f64,
    /// The state after a thousand steps.
    pub state: Vec<f64>,
}

impl Stopwatch {
    /// Creates a stopwatch for so many steps after the warm-up.
    #[must_use]
    pub const fn new(steps: u32) -> Self {
        Self {
            steps,
            step_ns: 0.0,
            state: Vec::new(),
        }
    }

    fn time<T: Copy, const N: usize>(
        &mut self,
        measurements: impl Fn(u32) -> [T; 2],
        mut step: impl FnMut([T; 2]) -> [T; N],
    ) where
        f64: From<T>,
    {
        for number in 0..WARM_UP {
            self.state = step(measurements(number)).map(f64::from).to_vec();
        }
        // The measurements repeat. They are made here, so that this is not timed.
        let measured: [[T; 2]; 23] = std::array::from_fn(|k| measurements(k as u32));
        let rounds = self.steps.div_ceil(measured.len() as u32);
        let started = Instant::now();
        for _ in 0..rounds {
            for both in &measured {
                black_box(step(black_box(*both)));
            }
        }
        let steps = (rounds as usize * measured.len()) as f64;
        self.step_ns = started.elapsed().as_secs_f64() * 1e9 / steps;
    }
}

impl single::model::FilterMeter for Stopwatch {
    fn measure<const N: usize>(&mut self, _: usize, step: impl FnMut([f32; 2]) -> [f32; N]) {
        self.time(single::model::measurements, step);
    }
}

impl double::model::FilterMeter for Stopwatch {
    fn measure<const N: usize>(&mut self, _: usize, step: impl FnMut([f64; 2]) -> [f64; N]) {
        self.time(double::model::measurements, step);
    }
}
