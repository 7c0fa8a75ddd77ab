//! The map on the vehicle, and the grade ahead.

use crate::estimate::FinishedCell;
use crate::estimator::Estimator;
use crate::pointer::{check_out, slice, write};
use crate::slot::Slot;
use crate::status::{Status, status};
use core::ffi::c_void;
use core::mem::MaybeUninit;
use estimator_core::Uncertain;
use estimator_core::roadmap::{Horizon, MapLive, MapMatch, PackedMap};

/// Memory for a map's place and horizon, bytes. It is enough on every target; `grade_map_bytes` tells
/// the exact number. The map itself stays where it is.
pub const GRADE_MAP_BYTES: usize = 8192;

const _: () = assert!(size_of::<Map>() <= GRADE_MAP_BYTES);
const _: () = assert!(align_of::<Map>() <= crate::estimator::GRADE_ALIGNMENT);

/// A map that a vehicle follows, in the caller's memory.
pub struct Map {
    #[expect(dead_code, reason = "reached by its address")]
    slot: Slot<MapLive<'static>>,
}

/// The live grade with the map.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct MapEstimate {
    /// Whether the map has a grade here.
    pub has_map_grade: bool,
    /// Grade of the map, with the error of the place, %.
    pub map_grade_percent: Uncertain,
    /// Whether estimate and map are combined: not where the map is left out.
    pub has_combined_grade: bool,
    /// Live grade and grade of the map together, %.
    pub combined_grade_percent: Uncertain,
    /// Whether the map is left out because it differs from the estimate.
    pub is_left_out: bool,
}

/// A place ahead.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PlaceAhead {
    /// Number of its branch; 0 is the most probable path.
    pub branch: u32,
    /// Probability of the branch, seen from the vehicle.
    pub probability: f32,
    /// Distance from the vehicle, m.
    pub ahead_m: f32,
    /// Whether the map has a grade there.
    pub has_grade: bool,
    /// Grade there, %.
    pub grade_percent: Uncertain,
}

impl Map {
    /// Returns the slot at a pointer.
    ///
    /// # Safety
    /// As for [`Slot::at`].
    #[allow(unsafe_code, reason = "border to C")]
    unsafe fn slot<'a>(pointer: *mut Self) -> Result<&'a Slot<MapLive<'static>>, Status> {
        // SAFETY: the caller's promise. The slot is the only field.
        unsafe { Slot::at(pointer.cast_const().cast()) }
    }
}

/// Returns the memory that a map takes on this target, bytes.
#[unsafe(no_mangle)]
#[allow(unsafe_code, reason = "border to C")]
pub extern "C" fn grade_map_bytes() -> usize {
    size_of::<Map>()
}

/// Opens a packed map of `length` bytes (docs/map-grade.md) in `bytes` bytes of `memory`, aligned to
/// `GRADE_ALIGNMENT`. The packed map is read in place, from flash for example.
///
/// Errors: `NULL`, `MISALIGNED`, `TOO_SMALL`, `ALREADY_CREATED`, `BUSY`, `MAP`.
///
/// # Safety
/// `memory` has `bytes` bytes, which only this library uses until the release. `packed` leads to
/// `length` bytes that do not change until then.
#[unsafe(no_mangle)]
#[allow(unsafe_code, reason = "border to C")]
pub unsafe extern "C" fn grade_map_create(
    memory: *mut c_void,
    bytes: usize,
    packed: *const u8,
    length: usize,
    out: *mut *mut Map,
) -> Status {
    let create = || {
        check_out(out)?;
        if packed.is_null() {
            return Err(Status::Null);
        }
        // SAFETY: the caller's promise.
        let packed: &'static [u8] = unsafe { slice(packed, length) }?;
        let make = |place: &mut MaybeUninit<MapLive<'static>>| {
            let map = PackedMap::open(packed).map_err(|_| Status::Map)?;
            place.write(MapLive::new(map));
            Ok(())
        };
        // SAFETY: the caller's promise.
        let slot = unsafe { Slot::create(memory, bytes, make) }?;
        // SAFETY: the caller's promise.
        unsafe { write(out, slot.cast()) }
    };
    status(create())
}

/// Releases a map. Its memory is the caller's again.
///
/// Errors: `NULL`, `MISALIGNED`, `NOT_CREATED`, `BUSY`.
///
/// # Safety
/// `map` leads to memory of a map.
#[unsafe(no_mangle)]
#[allow(unsafe_code, reason = "border to C")]
pub unsafe extern "C" fn grade_map_release(map: *mut Map) -> Status {
    // SAFETY: the caller's promise.
    status(unsafe { Map::slot(map) }.and_then(Slot::release))
}

/// Moves the estimator over one cell, and the map with it: instead of `grade_step`.
///
/// Errors: those of `grade_step`, of either object.
///
/// # Safety
/// `map` and `estimator` lead to memory of theirs.
#[unsafe(no_mangle)]
#[allow(unsafe_code, reason = "border to C")]
pub unsafe extern "C" fn grade_map_step(map: *mut Map, estimator: *mut Estimator) -> Status {
    // SAFETY: the caller's promise.
    let (map, estimator) = unsafe { (Map::slot(map), Estimator::slot(estimator)) };
    let step = || {
        map?.with(|map| {
            estimator?.with(|estimator| {
                estimator.step().ok_or(Status::Nothing)?;
                if let Some(live) = estimator.live() {
                    map.advance(&live);
                }
                Ok(())
            })
        })
    };
    status(step())
}

/// Returns the next finished cell, and compares the map with it: instead of `grade_next_cell`.
///
/// Errors: those of `grade_next_cell`, of either object.
///
/// # Safety
/// `map` and `estimator` lead to memory of theirs, `out` to an object of its type.
#[unsafe(no_mangle)]
#[allow(unsafe_code, reason = "border to C")]
pub unsafe extern "C" fn grade_map_next_cell(
    map: *mut Map,
    estimator: *mut Estimator,
    out: *mut FinishedCell,
) -> Status {
    // SAFETY: the caller's promise.
    let (map, estimator) = unsafe { (Map::slot(map), Estimator::slot(estimator)) };
    let next = || {
        check_out(out)?;
        let cell = map?.with(|map| {
            let cell = estimator?.with(|estimator| estimator.next_cell().ok_or(Status::Nothing))?;
            map.finish(&cell);
            Ok(cell)
        })?;
        // SAFETY: the caller's promise.
        unsafe { write(out, cell.into()) }
    };
    status(next())
}

/// Returns the live grade with the map.
///
/// Errors: `NULL`, `MISALIGNED`, `NOT_CREATED`, `BUSY`.
///
/// # Safety
/// `map` leads to memory of a map, `out` to an object of its type.
#[unsafe(no_mangle)]
#[allow(unsafe_code, reason = "border to C")]
pub unsafe extern "C" fn grade_map_live(map: *mut Map, out: *mut MapEstimate) -> Status {
    // SAFETY: the caller's promise.
    let slot = unsafe { Map::slot(map) };
    let estimate = |map: &mut MapLive<'static>| {
        let (own, combined) = (map.map_grade_percent(), map.combined_percent());
        Ok(MapEstimate {
            has_map_grade: own.is_some(),
            map_grade_percent: own.unwrap_or_default(),
            has_combined_grade: combined.is_some(),
            combined_grade_percent: combined.unwrap_or_default(),
            is_left_out: map.is_left_out(),
        })
    };
    let estimate = slot.and_then(|slot| slot.with(estimate));
    // SAFETY: the caller's promise.
    status(estimate.and_then(|estimate| unsafe { write(out, estimate) }))
}

/// Writes the grade ahead to at most `capacity` places: each branch every `step_m` metres up to
/// `length_m`, the most probable path first. `count` is the number of places written. Where the
/// capacity does not suffice, the farther places and the less probable branches are left out.
///
/// Errors: `NULL`, `MISALIGNED`, `NOT_CREATED`, `BUSY`, `DISTANCE`, `MAP`; `NOTHING` where the place on
/// the map is not known.
///
/// # Safety
/// `map` leads to memory of a map, `out` to memory for `capacity` places, `count` to a number.
#[unsafe(no_mangle)]
#[allow(unsafe_code, reason = "border to C")]
pub unsafe extern "C" fn grade_map_horizon(
    map: *mut Map,
    length_m: f32,
    step_m: f32,
    out: *mut PlaceAhead,
    capacity: usize,
    count: *mut usize,
) -> Status {
    // SAFETY: the caller's promise.
    let slot = unsafe { Map::slot(map) };
    let write_all = |map: &mut MapLive<'static>| {
        let matcher = map.matcher();
        let MapMatch::On(place) = matcher.place() else {
            return Err(Status::Nothing);
        };
        let horizon = Horizon::new(*matcher.map(), &place, length_m).map_err(|_| Status::Map)?;
        let branches = horizon.branches().iter().enumerate();
        let places = branches.flat_map(|(number, branch)| {
            horizon.points(branch, step_m).map(move |point| PlaceAhead {
                branch: number as u32,
                probability: branch.probability,
                ahead_m: point.ahead_m,
                has_grade: point.grade_percent.is_some(),
                grade_percent: point.grade_percent.unwrap_or_default(),
            })
        });
        let mut written = 0;
        for place in places.take(capacity) {
            // SAFETY: the pointer is checked, and this place is within its capacity.
            unsafe { out.add(written).write(place) };
            written += 1;
        }
        Ok(written)
    };
    let horizon = || {
        check_out(out)?;
        check_out(count)?;
        let is_distance = |metres: f32| metres.is_finite() && metres > 0.0;
        if !is_distance(length_m) || !is_distance(step_m) {
            return Err(Status::Distance);
        }
        let written = slot?.with(write_all)?;
        // SAFETY: the caller's promise.
        unsafe { write(count, written) }
    };
    status(horizon())
}
