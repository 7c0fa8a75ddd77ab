//! The same work for every filter: a prediction and an update by two scalar measurements.
//!
//! The model is linear. Its matrices are dense and not known at compile time. The states are speed,
//! altitude and slope; all further states are slow and add to the slope. Speed and altitude are
//! measured every 50 ms. Peers take both measurements in one update, the cheapest that they offer.
//! All filters run for the same thousand steps and report their last state. The states must agree.
//!
//! An image holds one filter and prints words, not text. Its size less that of the image without a
//! filter is the size of the filter.

#![no_std]
#![warn(missing_docs)]

pub mod dense;
pub mod minikalman_filter;
pub mod model;
pub mod ours;

use firmware::meter::{CountTally, InstructionMeter, Uncountable, depth};
use model::{FilterMeter, measurements};
use semihosting::io::{self, Write};

/// Number type of the filters here. Their modules use it as `super::Real`, since `tests/benches`
/// includes the same files in single and in double precision.
pub type Real = f32;

const STEPS: u32 = 1_000;

/// Counts on the board and prints instructions (mean and worst), bytes of stack, bytes of the
/// filter, and the state.
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

/// Prints a word. Ignores an error: the host detects the missing word.
fn print(word: u32) {
    if let Ok(mut stdout) = io::stdout() {
        let _ = stdout.write_all(&word.to_le_bytes());
    }
}

/// Defines the image of one filter: `main`, from an expression that measures it.
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
