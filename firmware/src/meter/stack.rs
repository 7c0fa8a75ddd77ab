//! The stack depth of a call. The stack below the call is painted, and the remaining paint is
//! measured afterwards.

#![allow(unsafe_code)]

use core::ptr;
use cortex_m::register::msp;

/// Painted bytes. A deeper stack is not measured to its end.
const PAINTED_BYTES: usize = 128 * 1024;
/// Bytes below the painter that stay free for its own calls.
const MARGIN_BYTES: usize = 64;
const PAINT: u32 = 0xc5c5_5c5c;
const WORD: usize = size_of::<u32>();

/// Does the work. Returns its result and the bytes of stack that it took.
///
/// The image must have 128 kB of free stack.
#[inline(never)]
pub fn depth<R>(work: impl FnOnce() -> R) -> (R, usize) {
    let top = msp::read() as usize;
    let (first, last) = (top - PAINTED_BYTES, top - MARGIN_BYTES);
    for address in (first..last).step_by(WORD) {
        // SAFETY: below the stack pointer, so unused; inside the stack, as the caller promises.
        unsafe { ptr::write_volatile(ptr::with_exposed_provenance_mut(address), PAINT) };
    }
    let result = work();
    let painted = (first..last).step_by(WORD).take_while(|address| {
        // SAFETY: as above, and written before.
        let word: u32 = unsafe { ptr::read_volatile(ptr::with_exposed_provenance(*address)) };
        word == PAINT
    });
    (result, top - (first + painted.count() * WORD))
}
