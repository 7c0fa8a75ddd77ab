//! A short row of values, the newest first.

use core::mem;

/// Puts a value at the front of a row. The others move back by one, the last one drops out.
///
/// `copy_within` would link the library's function for long moves, which is larger than the rest of
/// what uses it.
#[inline(never)] // Of any length, so that no compiler unrolls it.
pub(crate) fn shift_in<T>(row: &mut [T], newest: T) {
    row.iter_mut()
        .fold(newest, |before, place| mem::replace(place, before));
}
