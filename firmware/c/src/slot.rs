//! A value in the caller's memory, and the protection of it.

use crate::status::Status;
use core::cell::UnsafeCell;
use core::ffi::c_void;
use core::mem::MaybeUninit;
use core::sync::atomic::{AtomicU32, Ordering};

/// States of a slot. Each is mixed with the address, so that memory that was copied elsewhere is not
/// taken for a slot.
const READY: u32 = 0x6772_6164;
const IN_USE: u32 = 0x6573_6c6f;

/// A value, and a word that says whether it is there and whether a call works on it.
pub(crate) struct Slot<T> {
    state: AtomicU32,
    value: UnsafeCell<MaybeUninit<T>>,
}

/// A call that works on a slot. The slot is free again when this is dropped.
struct Claim<'a> {
    state: &'a AtomicU32,
    afterwards: u32,
}

impl Drop for Claim<'_> {
    fn drop(&mut self) {
        self.state.store(self.afterwards, Ordering::Release);
    }
}

/// Replaces the word if it is `from`; returns what it was.
#[cfg(target_has_atomic = "32")]
fn replace(state: &AtomicU32, from: u32, to: u32) -> u32 {
    match state.compare_exchange(from, to, Ordering::Acquire, Ordering::Relaxed) {
        Ok(was) | Err(was) => was,
    }
}

/// Replaces the word if it is `from`; returns what it was. These cores have one processor. An
/// interrupt between load and store ends its call, and so leaves the word as it was.
#[cfg(not(target_has_atomic = "32"))]
fn replace(state: &AtomicU32, from: u32, to: u32) -> u32 {
    let was = state.load(Ordering::Acquire);
    if was == from {
        state.store(to, Ordering::Relaxed);
    }
    was
}

impl<T> Slot<T> {
    fn mixed(&self, state: u32) -> u32 {
        state ^ core::ptr::from_ref(self).addr() as u32
    }

    /// Returns the slot at a pointer.
    ///
    /// # Safety
    /// The pointer is null, misaligned, or leads to initialized memory of the size of a slot, which
    /// nobody else reads or writes for `'a`.
    #[allow(unsafe_code, reason = "border to C")]
    pub(crate) unsafe fn at<'a>(pointer: *const Self) -> Result<&'a Self, Status> {
        if pointer.is_null() {
            return Err(Status::Null);
        }
        if !pointer.is_aligned() {
            return Err(Status::Misaligned);
        }
        // SAFETY: it is neither null nor misaligned; any content is a state and an unknown value.
        Ok(unsafe { &*pointer })
    }

    /// Creates a value in `bytes` bytes of memory; `make` writes it where it stays. Returns the slot.
    ///
    /// # Safety
    /// As for [`Slot::at`]; and the memory has `bytes` bytes.
    #[allow(unsafe_code, reason = "border to C")]
    pub(crate) unsafe fn create(
        memory: *mut c_void,
        bytes: usize,
        make: impl FnOnce(&mut MaybeUninit<T>) -> Result<(), Status>,
    ) -> Result<*mut Self, Status> {
        let pointer = memory.cast::<Self>();
        crate::pointer::check_out(pointer)?;
        if bytes < size_of::<Self>() {
            return Err(Status::TooSmall);
        }
        // SAFETY: the caller's promise; the size is checked.
        let slot = unsafe { Self::at(pointer) }?;
        let before = slot.state.load(Ordering::Acquire);
        if before == slot.mixed(READY) {
            return Err(Status::AlreadyCreated);
        }
        let in_use = slot.mixed(IN_USE);
        if before == in_use || replace(&slot.state, before, in_use) != before {
            return Err(Status::Busy);
        }
        let mut claim = Claim {
            state: &slot.state,
            afterwards: 0,
        };
        // SAFETY: the claim keeps every other call away from the value.
        make(unsafe { &mut *slot.value.get() })?;
        claim.afterwards = slot.mixed(READY);
        Ok(pointer)
    }

    /// Works on the value.
    #[allow(unsafe_code, reason = "border to C")]
    pub(crate) fn with<R>(
        &self,
        work: impl FnOnce(&mut T) -> Result<R, Status>,
    ) -> Result<R, Status> {
        let ready = self.mixed(READY);
        let _claim = self.claim(ready)?;
        // SAFETY: the word said that the value is there, and the claim keeps every other call away.
        work(unsafe { (*self.value.get()).assume_init_mut() })
    }

    /// Drops the value. The memory is the caller's again.
    #[allow(unsafe_code, reason = "border to C")]
    pub(crate) fn release(&self) -> Result<(), Status> {
        let _claim = self.claim(0)?;
        // SAFETY: as in `with`; afterwards, the word says that there is no value.
        unsafe { (*self.value.get()).assume_init_drop() };
        Ok(())
    }

    fn claim(&self, afterwards: u32) -> Result<Claim<'_>, Status> {
        let in_use = self.mixed(IN_USE);
        let was = replace(&self.state, self.mixed(READY), in_use);
        if was == in_use {
            return Err(Status::Busy);
        }
        if was != self.mixed(READY) {
            return Err(Status::NotCreated);
        }
        Ok(Claim {
            state: &self.state,
            afterwards,
        })
    }
}
