//! Counts instead of times: instructions, by the emulator's clock, and bytes of stack.
//!
//! QEMU with `-icount shift=N` lets each instruction last 2^N ns of its own time, in which the
//! SysTick of the board ticks every 40 ns. With N = 6 an instruction takes more than one tick, so
//! that they give its count, and 24 bits of them last for ten million. Whatever it is, the ratio
//! is measured on a loop whose instructions are known.

mod stack;
mod tally;

pub use stack::depth;
pub use tally::CountTally;

use core::fmt;
use core::hint::black_box;
use core::sync::atomic::{Ordering, compiler_fence};
use cortex_m::peripheral::SYST;
use cortex_m::peripheral::syst::SystClkSource;

/// All of the timer's 24 bits.
const FULL: u32 = 0x00ff_ffff;
/// Turns of the loop that calibrates a tick, and its instructions, two a turn.
const TURNS: u32 = 100_000;
const LOOP: u64 = 2 * TURNS as u64;

/// A counter of instructions.
pub struct InstructionMeter {
    timer: SYST,
    /// Ticks that the loop took.
    ticks_of_loop: u64,
    /// Ticks that counting nothing takes.
    overhead: u32,
}

/// Why instructions cannot be counted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Uncountable {
    /// Another has the timer.
    NoTimer,
    /// The emulator was started without `-icount`, or with too small a shift.
    TooCoarse,
    /// More than the timer's bits hold.
    TooMany,
}

impl InstructionMeter {
    /// Starts the timer and finds out how many ticks an instruction takes.
    ///
    /// # Errors
    /// All but [`Uncountable::TooMany`].
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

    /// Does the work, and counts its instructions.
    ///
    /// # Errors
    /// [`Uncountable::TooMany`], after the work was done.
    pub fn count<R>(&mut self, work: impl FnOnce() -> R) -> Result<(R, u32), Uncountable> {
        let (result, ticks) = self.ticks(work)?;
        let ticks = u64::from(ticks.saturating_sub(self.overhead));
        let instructions = (ticks * LOOP + self.ticks_of_loop / 2) / self.ticks_of_loop;
        Ok((result, instructions as u32))
    }

    /// Not inlined: what is counted must not depend on what the compiler makes of the caller.
    #[inline(never)]
    fn ticks<R>(&mut self, work: impl FnOnce() -> R) -> Result<(R, u32), Uncountable> {
        // Reading the flag clears it. It is read within, so that a wrap beside the work is not
        // taken for one too many.
        let before = SYST::get_current();
        self.timer.has_wrapped();
        compiler_fence(Ordering::SeqCst);
        // By reference: handed over, a large result would be copied, and the copy counted.
        let result = work();
        black_box(&result);
        compiler_fence(Ordering::SeqCst);
        let wrapped = self.timer.has_wrapped();
        let after = SYST::get_current();
        // It counts down. Around once is what the mask undoes, but not further.
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
