//! Counts of instructions, by the emulator's clock, and of bytes of stack.
//!
//! With `-icount shift=N` each instruction takes 2^N ns of QEMU's time. The SysTick of the board
//! ticks every 40 ns of that time. With N = 6 an instruction takes more than one tick, so the ticks
//! give the number of instructions. The 24 bits of the timer suffice for ten million instructions.
//! The number of ticks for an instruction is measured on a loop of known length.

mod stack;
mod tally;

pub use stack::depth;
pub use tally::CountTally;

use core::fmt;
use core::hint::black_box;
use core::sync::atomic::{Ordering, compiler_fence};
use cortex_m::peripheral::SYST;
use cortex_m::peripheral::syst::SystClkSource;

/// Largest value of the timer, which has 24 bits.
const FULL: u32 = 0x00ff_ffff;
/// Turns of the loop that calibrates the ticks, and its instructions: two a turn.
const TURNS: u32 = 100_000;
const LOOP: u64 = 2 * TURNS as u64;

/// A counter of instructions.
pub struct InstructionMeter {
    timer: SYST,
    /// Ticks that the loop took.
    ticks_of_loop: u64,
    /// Ticks of an empty measurement.
    overhead: u32,
}

/// Why instructions cannot be counted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Uncountable {
    /// The timer is already in use.
    NoTimer,
    /// The emulator was started without `-icount`, or with too small a shift.
    TooCoarse,
    /// A call took more ticks than the timer can count.
    TooMany,
}

impl InstructionMeter {
    /// Starts the timer and measures the number of ticks for an instruction.
    ///
    /// # Errors
    /// Returns [`Uncountable`] if the timer is in use or too coarse.
    pub fn new() -> Result<Self, Uncountable> {
        let peripherals = cortex_m::Peripherals::take().ok_or(Uncountable::NoTimer)?;
        let mut timer = peripherals.SYST;
        timer.set_clock_source(SystClkSource::Core);
        timer.set_reload(FULL);
        timer.clear_current();
        timer.enable_counter();
        let mut meter = Self {
            timer,
            ticks_of_loop: 0,
            overhead: 0,
        };
        let mut ticks = |turns| meter.ticks(|| cortex_m::asm::delay(turns));
        let (((), few), ((), many)) = (ticks(1)?, ticks(1 + TURNS)?);
        meter.ticks_of_loop = u64::from(many.saturating_sub(few));
        if meter.ticks_of_loop < LOOP {
            return Err(Uncountable::TooCoarse);
        }
        ((), meter.overhead) = meter.ticks(|| ())?;
        Ok(meter)
    }

    /// Does the work and counts its instructions.
    ///
    /// # Errors
    /// Returns [`Uncountable::TooMany`] after the work is done.
    pub fn count<R>(&mut self, work: impl FnOnce() -> R) -> Result<(R, u32), Uncountable> {
        let (result, ticks) = self.ticks(work)?;
        let ticks = u64::from(ticks.saturating_sub(self.overhead));
        let instructions = (ticks * LOOP + self.ticks_of_loop / 2) / self.ticks_of_loop;
        Ok((result, instructions as u32))
    }

    /// Does the work and counts its ticks. Not inlined, so that the count does not depend on the
    /// caller.
    #[inline(never)]
    fn ticks<R>(&mut self, work: impl FnOnce() -> R) -> Result<(R, u32), Uncountable> {
        // Reading the flag clears it. It is read after the first reading of the timer and before
        // the last, so that a wrap outside the work does not count.
        let before = SYST::get_current();
        self.timer.has_wrapped();
        compiler_fence(Ordering::SeqCst);
        // By reference: a large result by value would be copied, and the copy counted.
        let result = work();
        black_box(&result);
        compiler_fence(Ordering::SeqCst);
        let wrapped = self.timer.has_wrapped();
        let after = SYST::get_current();
        // The timer counts down. The mask corrects one wrap, but no more.
        if wrapped && after <= before {
            return Err(Uncountable::TooMany);
        }
        Ok((result, before.wrapping_sub(after) & FULL))
    }
}

impl fmt::Display for Uncountable {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::NoTimer => "the timer is taken",
            Self::TooCoarse => "the clock is too coarse: start QEMU with -icount shift=6",
            Self::TooMany => "a call took more instructions than can be counted",
        })
    }
}
