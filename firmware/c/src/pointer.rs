//! Pointers of a C program. Null and misaligned ones are refused. That a pointer leads to memory of
//! its type is what no callee can check: it is the caller's promise.

use crate::status::Status;

/// Refuses a pointer that is null or misaligned.
fn check<T>(pointer: *const T) -> Result<(), Status> {
    if pointer.is_null() {
        Err(Status::Null)
    } else if !pointer.is_aligned() {
        Err(Status::Misaligned)
    } else {
        Ok(())
    }
}

/// Refuses pointers for results before anything is done for them.
pub(crate) fn check_out<T>(pointer: *mut T) -> Result<(), Status> {
    check(pointer.cast_const())
}

/// Reads an object.
///
/// # Safety
/// The pointer is null, misaligned, or leads to an initialized object.
#[allow(unsafe_code, reason = "border to C")]
pub(crate) unsafe fn read<T: Copy>(pointer: *const T) -> Result<T, Status> {
    check(pointer)?;
    // SAFETY: it is neither null nor misaligned, so it leads to an object.
    Ok(unsafe { pointer.read() })
}

/// Writes an object.
///
/// # Safety
/// The pointer is null, misaligned, or leads to memory for an object.
#[allow(unsafe_code, reason = "border to C")]
pub(crate) unsafe fn write<T: Copy>(pointer: *mut T, value: T) -> Result<(), Status> {
    check_out(pointer)?;
    // SAFETY: it is neither null nor misaligned, so it leads to memory for an object.
    unsafe { pointer.write(value) };
    Ok(())
}

/// Returns a buffer that is read. A null pointer is an empty buffer if the length is 0.
///
/// # Safety
/// The pointer is null, misaligned, or leads to `length` initialized objects, which nobody changes
/// for `'a`.
#[allow(unsafe_code, reason = "border to C")]
pub(crate) unsafe fn slice<'a, T>(pointer: *const T, length: usize) -> Result<&'a [T], Status> {
    if length == 0 {
        return Ok(&[]);
    }
    check(pointer)?;
    if length > isize::MAX as usize / size_of::<T>() {
        return Err(Status::TooSmall);
    }
    // SAFETY: it is neither null nor misaligned, so it leads to `length` objects; their size is checked.
    Ok(unsafe { core::slice::from_raw_parts(pointer, length) })
}

/// Copies objects to a buffer.
///
/// # Safety
/// The pointer is null, misaligned, or leads to memory for `capacity` objects.
#[allow(unsafe_code, reason = "border to C")]
pub(crate) unsafe fn copy<T: Copy>(
    from: &[T],
    pointer: *mut T,
    capacity: usize,
) -> Result<(), Status> {
    check_out(pointer)?;
    if capacity < from.len() {
        return Err(Status::TooSmall);
    }
    // SAFETY: it is neither null nor misaligned, so it leads to memory for `capacity` objects. What is
    // copied lies in a value of this crate, which the caller's memory cannot overlap.
    unsafe { pointer.copy_from_nonoverlapping(from.as_ptr(), from.len()) };
    Ok(())
}
