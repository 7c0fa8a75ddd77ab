//! The estimator.

use crate::estimate::{FinishedCell, LiveEstimate};
use crate::frame::ClassicFrame;
use crate::pointer::{check_out, copy, read, slice, write};
use crate::slot::Slot;
use crate::status::{Status, status};
use crate::vehicle::Vehicle;
use core::ffi::{c_char, c_void};
use core::mem::MaybeUninit;
use estimator_core::packed_vehicle;
use estimator_core::{
    Counters, Instant, Model, PersistentState, Reading, Signal, Step, Tuning, Value,
};

/// Memory for an estimator, bytes. It is enough on every target; `grade_estimator_bytes` tells the
/// exact number.
pub const GRADE_ESTIMATOR_BYTES: usize = 98304;
/// Alignment of that memory, bytes.
pub const GRADE_ALIGNMENT: usize = 8;
/// Length of a packed vehicle, bytes.
pub const GRADE_PACKED_VEHICLE_BYTES: usize = 1008;
/// Length of a persistent state, bytes.
pub const GRADE_PERSISTENT_STATE_BYTES: usize = 108;

const _: () = assert!(size_of::<Estimator>() <= GRADE_ESTIMATOR_BYTES);
const _: () = assert!(align_of::<Estimator>() <= GRADE_ALIGNMENT);
const _: () = assert!(GRADE_PACKED_VEHICLE_BYTES == packed_vehicle::VEHICLE_BYTES);
const _: () = assert!(GRADE_PERSISTENT_STATE_BYTES == PersistentState::LEN);

/// A grade estimator for one vehicle, in the caller's memory.
pub struct Estimator {
    #[expect(dead_code, reason = "reached by its address")]
    slot: Slot<estimator_core::Estimator<f32>>,
}

impl Estimator {
    /// Returns the slot at a pointer.
    ///
    /// # Safety
    /// As for [`Slot::at`].
    #[allow(unsafe_code, reason = "border to C")]
    pub(crate) unsafe fn slot<'a>(
        pointer: *mut Self,
    ) -> Result<&'a Slot<estimator_core::Estimator<f32>>, Status> {
        // SAFETY: the caller's promise. The slot is the only field.
        unsafe { Slot::at(pointer.cast_const().cast()) }
    }
}

/// Returns the version of this library, as "major.minor.patch".
#[unsafe(no_mangle)]
#[allow(unsafe_code, reason = "border to C")]
pub extern "C" fn grade_version() -> *const c_char {
    concat!(env!("CARGO_PKG_VERSION"), "\0").as_ptr().cast()
}

/// Returns the memory that an estimator takes on this target, bytes.
#[unsafe(no_mangle)]
#[allow(unsafe_code, reason = "border to C")]
pub extern "C" fn grade_estimator_bytes() -> usize {
    size_of::<Estimator>()
}

/// Creates an estimator for a vehicle in `bytes` bytes of `memory`, aligned to
/// `GRADE_ALIGNMENT`. Zero the memory before the first time. Its place must not change.
///
/// Errors: `NULL`, `MISALIGNED`, `TOO_SMALL`, `ALREADY_CREATED`, `BUSY`, `VEHICLE`.
///
/// # Safety
/// `memory` has `bytes` bytes, which only this library uses until the release; `vehicle` and `out`
/// lead to objects of their types.
#[unsafe(no_mangle)]
#[allow(unsafe_code, reason = "border to C")]
pub unsafe extern "C" fn grade_create(
    memory: *mut c_void,
    bytes: usize,
    vehicle: *const Vehicle,
    out: *mut *mut Estimator,
) -> Status {
    // SAFETY: the caller's promise.
    let model = || unsafe { read(vehicle) }?.model();
    // SAFETY: the caller's promise.
    status(unsafe { create(memory, bytes, model, None, out) })
}

/// Creates an estimator for a packed vehicle (docs/formats.md), as `grade_create` does.
///
/// Errors: those of `grade_create`, and `PACKED_VEHICLE`.
///
/// # Safety
/// As for `grade_create`; `vehicle` leads to `length` bytes.
#[unsafe(no_mangle)]
#[allow(unsafe_code, reason = "border to C")]
pub unsafe extern "C" fn grade_create_packed(
    memory: *mut c_void,
    bytes: usize,
    vehicle: *const u8,
    length: usize,
    out: *mut *mut Estimator,
) -> Status {
    // SAFETY: the caller's promise.
    let model = || unsafe { packed(vehicle, length) };
    // SAFETY: the caller's promise.
    status(unsafe { create(memory, bytes, model, None, out) })
}

/// Creates an estimator for a vehicle that begins with what an earlier drive left.
///
/// Errors: those of `grade_create`, `PERSISTENT_STATE` and `OTHER_VEHICLE`. After either of these,
/// begin without it.
///
/// # Safety
/// As for `grade_create`; `state` leads to `state_length` bytes.
#[unsafe(no_mangle)]
#[allow(unsafe_code, reason = "border to C")]
pub unsafe extern "C" fn grade_restore(
    memory: *mut c_void,
    bytes: usize,
    vehicle: *const Vehicle,
    state: *const u8,
    state_length: usize,
    out: *mut *mut Estimator,
) -> Status {
    // SAFETY: the caller's promise.
    let model = || unsafe { read(vehicle) }?.model();
    // SAFETY: the caller's promise.
    let restored = unsafe { kept(state, state_length) };
    // SAFETY: the caller's promise.
    status(restored.and_then(|state| unsafe { create(memory, bytes, model, Some(&state), out) }))
}

/// Creates an estimator for a packed vehicle that begins with what an earlier drive left.
///
/// Errors: those of `grade_create_packed` and `grade_restore`.
///
/// # Safety
/// As for `grade_create_packed` and `grade_restore`.
#[unsafe(no_mangle)]
#[allow(unsafe_code, reason = "border to C")]
pub unsafe extern "C" fn grade_restore_packed(
    memory: *mut c_void,
    bytes: usize,
    vehicle: *const u8,
    length: usize,
    state: *const u8,
    state_length: usize,
    out: *mut *mut Estimator,
) -> Status {
    // SAFETY: the caller's promise.
    let model = || unsafe { packed(vehicle, length) };
    // SAFETY: the caller's promise.
    let restored = unsafe { kept(state, state_length) };
    // SAFETY: the caller's promise.
    status(restored.and_then(|state| unsafe { create(memory, bytes, model, Some(&state), out) }))
}

/// Returns a persistent state.
///
/// # Safety
/// As for `grade_restore`.
#[allow(unsafe_code, reason = "border to C")]
unsafe fn kept(state: *const u8, length: usize) -> Result<PersistentState, Status> {
    if state.is_null() {
        return Err(Status::Null);
    }
    // SAFETY: the caller's promise.
    let bytes = unsafe { slice(state, length) }?;
    PersistentState::from_bytes(bytes).map_err(|_| Status::PersistentState)
}

/// Returns the model of a packed vehicle.
///
/// # Safety
/// As for `grade_create_packed`.
#[allow(unsafe_code, reason = "border to C")]
unsafe fn packed(vehicle: *const u8, length: usize) -> Result<Model, Status> {
    if vehicle.is_null() {
        return Err(Status::Null);
    }
    // SAFETY: the caller's promise.
    let bytes = unsafe { slice(vehicle, length) }?;
    packed_vehicle::decode(bytes).map_err(|_| Status::PackedVehicle)
}

/// Creates an estimator and tells where it is.
///
/// # Safety
/// As for `grade_create`.
#[allow(unsafe_code, reason = "border to C")]
unsafe fn create(
    memory: *mut c_void,
    bytes: usize,
    model: impl FnOnce() -> Result<Model, Status>,
    state: Option<&PersistentState>,
    out: *mut *mut Estimator,
) -> Result<(), Status> {
    check_out(out)?;
    let make = |place: &mut MaybeUninit<estimator_core::Estimator<f32>>| {
        let created = estimator_core::Estimator::new_in(place, &model()?, &Tuning::default());
        let estimator = created.map_err(|_| Status::Vehicle)?;
        match state {
            None => Ok(()),
            Some(state) => estimator.resume(state).map_err(|_| Status::OtherVehicle),
        }
    };
    // SAFETY: the caller's promise.
    let slot = unsafe { Slot::<estimator_core::Estimator<f32>>::create(memory, bytes, make) }?;
    // SAFETY: the caller's promise.
    unsafe { write(out, slot.cast()) }
}

/// Releases an estimator. Its memory is the caller's again.
///
/// Errors: `NULL`, `MISALIGNED`, `NOT_CREATED`, `BUSY`.
///
/// # Safety
/// `estimator` leads to memory of an estimator.
#[unsafe(no_mangle)]
#[allow(unsafe_code, reason = "border to C")]
pub unsafe extern "C" fn grade_release(estimator: *mut Estimator) -> Status {
    // SAFETY: the caller's promise.
    status(unsafe { Estimator::slot(estimator) }.and_then(Slot::release))
}

/// Takes one classic CAN data frame, received at `time_us` by any clock that only goes forward.
/// Leave out error and remote frames. What is unusable is counted (`grade_counters`).
///
/// Errors: `NULL`, `MISALIGNED`, `NOT_CREATED`, `BUSY`, `FRAME`.
///
/// # Safety
/// `estimator` leads to memory of an estimator, `data` to `length` bytes.
#[unsafe(no_mangle)]
#[allow(unsafe_code, reason = "border to C")]
pub unsafe extern "C" fn grade_on_frame(
    estimator: *mut Estimator,
    time_us: u64,
    identifier: u32,
    is_extended: u8,
    data: *const u8,
    length: usize,
) -> Status {
    if length > 8 {
        return Status::Frame;
    }
    // SAFETY: the caller's promise.
    let (slot, data) = unsafe { (Estimator::slot(estimator), slice(data, length)) };
    let take = || {
        let frame = ClassicFrame::from_parts(identifier, is_extended != 0, data?)?;
        slot?.with(|estimator| {
            let _ = estimator.on_frame(Instant::from_micros(time_us), &frame);
            Ok(())
        })
    };
    status(take())
}

/// Returns the number of the signal of this name, for `grade_on_reading`: a column of a signal table
/// (docs/formats.md), as "wheel_speed_mps".
///
/// Errors: `NULL`, `MISALIGNED`, `SIGNAL`.
///
/// # Safety
/// `name` leads to `length` bytes, `out` to a number.
#[unsafe(no_mangle)]
#[allow(unsafe_code, reason = "border to C")]
pub unsafe extern "C" fn grade_signal(name: *const c_char, length: usize, out: *mut u32) -> Status {
    if name.is_null() {
        return Status::Null;
    }
    // SAFETY: the caller's promise.
    let name = unsafe { slice(name.cast::<u8>(), length) };
    let find = || {
        let name = name?;
        let is_it = |signal: &Signal| signal.column().as_bytes() == name;
        let number = Signal::ALL.iter().position(is_it).ok_or(Status::Signal)?;
        // SAFETY: the caller's promise.
        unsafe { write(out, number as u32) }
    };
    status(find())
}

/// Takes one reading of a signal (`grade_signal`) that does not come from the bus, in the unit of its
/// name. A value that is not finite is "not available".
///
/// Errors: `NULL`, `MISALIGNED`, `NOT_CREATED`, `BUSY`, `SIGNAL`.
///
/// # Safety
/// `estimator` leads to memory of an estimator.
#[unsafe(no_mangle)]
#[allow(unsafe_code, reason = "border to C")]
pub unsafe extern "C" fn grade_on_reading(
    estimator: *mut Estimator,
    time_us: u64,
    signal: u32,
    value: f64,
) -> Status {
    // SAFETY: the caller's promise.
    let slot = unsafe { Estimator::slot(estimator) };
    let take = || {
        let signal = *Signal::ALL.get(signal as usize).ok_or(Status::Signal)?;
        let value = value_of(signal, value);
        slot?.with(|estimator| {
            let now = Instant::from_micros(time_us);
            let _ = estimator.on_reading(now, Reading { signal, value });
            Ok(())
        })
    };
    status(take())
}

/// Returns the value of a number: degrees of a position have more digits than `f32`.
fn value_of(signal: Signal, number: f64) -> Value {
    let largest_deg = match signal {
        Signal::Latitude => 90.0,
        Signal::Longitude => 180.0,
        _ if number.is_finite() => return Value::Real(number as f32),
        _ => return Value::NotAvailable,
    };
    if number.is_nan() {
        Value::NotAvailable
    } else if number.abs() > largest_deg {
        Value::Error
    } else {
        let nearest = if number < 0.0 { -0.5 } else { 0.5 };
        Value::DegreesE7((number * 1e7 + nearest) as i32)
    }
}

/// Does a share of work: moves the filter over one cell of 2.5 m, or goes on with the lagged
/// estimates. Call it after each frame until it returns `NOTHING`.
///
/// Errors: `NULL`, `MISALIGNED`, `NOT_CREATED`, `BUSY`; `NOTHING` if nothing is left to do.
///
/// # Safety
/// `estimator` leads to memory of an estimator.
#[unsafe(no_mangle)]
#[allow(unsafe_code, reason = "border to C")]
pub unsafe extern "C" fn grade_step(estimator: *mut Estimator) -> Status {
    // SAFETY: the caller's promise.
    let slot = unsafe { Estimator::slot(estimator) };
    let step = |estimator: &mut estimator_core::Estimator<f32>| match estimator.step() {
        Some(Step::Moved | Step::Skipped | Step::Smoothed) => Ok(()),
        None => Err(Status::Nothing),
    };
    status(slot.and_then(|slot| slot.with(step)))
}

/// Returns the estimate at the end of the newest cell.
///
/// Errors: `NULL`, `MISALIGNED`, `NOT_CREATED`, `BUSY`; `NOTHING` before the first cell.
///
/// # Safety
/// `estimator` leads to memory of an estimator, `out` to an object of its type.
#[unsafe(no_mangle)]
#[allow(unsafe_code, reason = "border to C")]
pub unsafe extern "C" fn grade_live(estimator: *mut Estimator, out: *mut LiveEstimate) -> Status {
    // SAFETY: the caller's promise.
    let slot = unsafe { Estimator::slot(estimator) };
    let live = slot.and_then(|slot| slot.with(|it| it.live().ok_or(Status::Nothing)));
    // SAFETY: the caller's promise.
    status(live.and_then(|live| unsafe { write(out, live.into()) }))
}

/// Returns the next finished cell, whose lag is over. Call it after each step until it returns
/// `NOTHING`.
///
/// Errors: `NULL`, `MISALIGNED`, `NOT_CREATED`, `BUSY`; `NOTHING` if none is finished.
///
/// # Safety
/// `estimator` leads to memory of an estimator, `out` to an object of its type.
#[unsafe(no_mangle)]
#[allow(unsafe_code, reason = "border to C")]
pub unsafe extern "C" fn grade_next_cell(
    estimator: *mut Estimator,
    out: *mut FinishedCell,
) -> Status {
    // SAFETY: the caller's promise.
    status(unsafe { fetch(estimator, out, estimator_core::Estimator::next_cell) })
}

/// Returns the next of the last cells of a drive, which are smoothed by less than the full lag. What
/// comes afterwards begins a new chain of cells.
///
/// Errors: as for `grade_next_cell`.
///
/// # Safety
/// As for `grade_next_cell`.
#[unsafe(no_mangle)]
#[allow(unsafe_code, reason = "border to C")]
pub unsafe extern "C" fn grade_drain_cell(
    estimator: *mut Estimator,
    out: *mut FinishedCell,
) -> Status {
    // SAFETY: the caller's promise.
    status(unsafe { fetch(estimator, out, estimator_core::Estimator::drain_cell) })
}

/// Writes the next cell of a kind. A pointer that cannot take it is refused first: no cell is lost.
///
/// # Safety
/// As for `grade_next_cell`.
#[allow(unsafe_code, reason = "border to C")]
unsafe fn fetch(
    estimator: *mut Estimator,
    out: *mut FinishedCell,
    next: fn(&mut estimator_core::Estimator<f32>) -> Option<estimator_core::Cell>,
) -> Result<(), Status> {
    check_out(out)?;
    // SAFETY: the caller's promise.
    let slot = unsafe { Estimator::slot(estimator) }?;
    let cell = slot.with(|estimator| next(estimator).ok_or(Status::Nothing))?;
    // SAFETY: the caller's promise.
    unsafe { write(out, cell.into()) }
}

/// Writes what this drive leaves for the next one to `capacity` bytes; it takes
/// `GRADE_PERSISTENT_STATE_BYTES`.
///
/// Errors: `NULL`, `MISALIGNED`, `TOO_SMALL`, `NOT_CREATED`, `BUSY`; `NOTHING` before 5 km with GNSS.
///
/// # Safety
/// `estimator` leads to memory of an estimator, `out` to `capacity` bytes.
#[unsafe(no_mangle)]
#[allow(unsafe_code, reason = "border to C")]
pub unsafe extern "C" fn grade_persistent_state(
    estimator: *mut Estimator,
    out: *mut u8,
    capacity: usize,
) -> Status {
    // SAFETY: the caller's promise.
    let slot = unsafe { Estimator::slot(estimator) };
    let state = slot.and_then(|slot| slot.with(|it| it.persistent_state().ok_or(Status::Nothing)));
    // SAFETY: the caller's promise.
    status(state.and_then(|state| unsafe { copy(&state.to_bytes(), out, capacity) }))
}

/// Returns the counts of what happened so far, by kind.
///
/// Errors: `NULL`, `MISALIGNED`, `NOT_CREATED`, `BUSY`.
///
/// # Safety
/// `estimator` leads to memory of an estimator, `out` to an object of its type.
#[unsafe(no_mangle)]
#[allow(unsafe_code, reason = "border to C")]
pub unsafe extern "C" fn grade_counters(estimator: *mut Estimator, out: *mut Counters) -> Status {
    // SAFETY: the caller's promise.
    let slot = unsafe { Estimator::slot(estimator) };
    let counters = slot.and_then(|slot| slot.with(|estimator| Ok(*estimator.counters())));
    // SAFETY: the caller's promise.
    status(counters.and_then(|counters| unsafe { write(out, counters) }))
}
