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
pub mod model;
pub mod ours;

use firmware::meter::{CountTally, InstructionMeter, Uncountable, depth};
use model::{FilterMeter, measurements};
use semihosting::io::{self, Write};

/// What filters compute in here. Their modules know it as `super::Real`: `tests/benches` has the same
/// files in single and in double precision.
pub type Real = f32;

const STEPS: u32 = 1_000;

/// Counts on the board, and prints: instructions (mean and worst), bytes of stack and of the filter,
/// the state.
#[derive(Debug)]
pub struct BoardMeter;

impl FilterMeter for BoardMeter {
    fn measure<const N: usize>(
        &mut self,
        bytes: usize,
        mut step: impl FnMut([Real; 2]) -> [Real; N],
    ) {
        let _ = count(bytes, &mut step);
    }
}

fn count<const N: usize>(
    bytes: usize,
    step: &mut impl FnMut([f32; 2]) -> [f32; N],
) -> Result<(), Uncountable> {
    let mut meter = InstructionMeter::new()?;
    let mut tally = CountTally::default();
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
