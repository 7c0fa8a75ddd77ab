//! The part of the flash in which a map is kept: the linker script reserves it, and a host flashes it.

#![allow(unsafe_code)]

use core::ptr::addr_of;
use core::slice;
use estimator_core::roadmap::{MapError, PackedMap};

unsafe extern "C" {
    /// First byte of the region, and the first one behind it.
    static _map_start: u8;
    static _map_end: u8;
}

/// Opens the map in flash.
///
/// # Errors
/// Says why there is no usable one: [`MapError::Magic`] if none was flashed.
pub fn open() -> Result<PackedMap<'static>, MapError> {
    let (start, end) = (addr_of!(_map_start), addr_of!(_map_end));
    let bytes = (end as usize).saturating_sub(start as usize);
    // SAFETY: the linker script reserves these bytes of flash for the map alone. Flash can be read at
    // any time, and no code here writes to it while the image runs.
    PackedMap::open(unsafe { slice::from_raw_parts(start, bytes) })
}
