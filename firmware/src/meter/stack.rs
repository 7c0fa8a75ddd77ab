//! How deep a call goes, by painting the stack below it and looking how far the paint is gone.

#![allow(unsafe_code)]

use core::ptr;
use cortex_m::register::msp;

/// What is painted; what goes deeper is not seen to its end.
const PAINTED_BYTES: usize = 128 * 1024;
/// Left free right below the painter: what the painter itself may call.
const MARGIN_BYTES: usize = 64;
const PAINT: u32 = 0xc5c5_5c5c;
const WORD: usize = size_of::<u32>();

/// Does the work; returns how many bytes of stack it took.
///
/// The image must have 128 kB of stack to spare.
#[inline(never)]
pub fn depth<R>(work: impl FnOnce() -> R) -> (R, usize) {
    let top = msp::read() as usize;
    let (first, last) = (top - PAINTED_BYTES, top - MARGIN_BYTES);
    for address in (first..last).step_by(WORD) {
        // SAFETY: below the stack pointer, so nobody's; inside the stack, as the caller promises.
        unsafe { ptr::write_volatile(ptr::with_exposed_provenance_mut(address), PAINT) };
    }
    let result = work();
    let painted = (first..last).step_by(WORD).take_while(|address| {
        // SAFETY: as above; written before.
        let word: u32 = unsafe { ptr::read_volatile(ptr::with_exposed_provenance(*address)) };
        word == PAINT
    });
    (result, top - (first + painted.count() * WORD))
}
