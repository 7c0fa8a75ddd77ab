//! Calls as a C program makes them: in order, out of order, and several at once. Small enough for Miri.

#![allow(unsafe_code, reason = "the functions are those of C")]

use core::ffi::c_void;
use core::ptr::null_mut;
use estimator_core::Counters;
use road_grade::estimate::LiveEstimate;
use road_grade::estimator::{
    Estimator, GRADE_ESTIMATOR_BYTES, grade_counters, grade_create, grade_estimator_bytes,
    grade_live, grade_on_reading, grade_release, grade_signal, grade_step, grade_version,
};
use road_grade::status::Status;
use road_grade::vehicle::{GRADE_MEASURED_FORCE, Vehicle};

/// Memory as a C program has it: aligned and zero.
#[repr(C, align(8))]
struct Memory([u8; GRADE_ESTIMATOR_BYTES]);

fn memory() -> Box<Memory> {
    Box::new(Memory([0; GRADE_ESTIMATOR_BYTES]))
}

fn truck() -> Vehicle {
    Vehicle {
        mass_kg: 19_000.0,
        drag_area_m2: 5.2,
        rolling_resistance: 0.008,
        wheel_radius_m: 0.48,
        wheel_inertia_kgm2: 60.0,
        gear_count: GRADE_MEASURED_FORCE,
        ..Vehicle::default()
    }
}

fn created(memory: &mut Memory) -> *mut Estimator {
    let mut estimator = null_mut();
    let place = memory.0.as_mut_ptr().cast::<c_void>();
    // SAFETY: the memory is as large as promised, and lives longer than the estimator.
    let status = unsafe { grade_create(place, memory.0.len(), &truck(), &mut estimator) };
    assert_eq!(status, Status::Ok);
    estimator
}

fn signal(name: &str) -> u32 {
    let mut number = 0;
    // SAFETY: name and number are this function's.
    let status = unsafe { grade_signal(name.as_ptr().cast(), name.len(), &mut number) };
    assert_eq!(status, Status::Ok, "{name}");
    number
}

#[test]
fn readings_become_a_live_estimate() {
    let mut memory = memory();
    let estimator = created(&mut memory);
    let [speed, force] = ["wheel_speed_mps", "traction_force_n"].map(signal);
    let mut steps = 0;
    for second in 0..4 {
        let time_us = second * 1_000_000;
        // SAFETY: the estimator was created.
        unsafe {
            assert_eq!(
                grade_on_reading(estimator, time_us, force, 2_000.0),
                Status::Ok
            );
            assert_eq!(
                grade_on_reading(estimator, time_us, speed, 10.0),
                Status::Ok
            );
            while grade_step(estimator) == Status::Ok {
                steps += 1;
            }
        }
    }
    let (mut live, mut counters) = (LiveEstimate::default(), Counters::default());
    // SAFETY: as above; the results are this function's.
    unsafe {
        assert_eq!(grade_live(estimator, &mut live), Status::Ok);
        assert_eq!(grade_counters(estimator, &mut counters), Status::Ok);
        assert_eq!(grade_release(estimator), Status::Ok);
        assert_eq!(grade_release(estimator), Status::NotCreated);
    }
    assert!(steps > 5, "{steps}");
    assert_eq!(live.end.speed_mps, 10.0);
    assert!(live.grade_percent.sigma > 0.0);
    assert_eq!(counters.steps, steps);
}

/// Threads are worse than interrupts: they go on while the call that they meet goes on.
#[test]
fn calls_that_meet_another_one_are_refused_or_done() {
    struct Shared(*mut Estimator);
    // SAFETY: the library protects the estimator; that is what is tested.
    unsafe impl Sync for Shared {}
    let mut memory = memory();
    let shared = Shared(created(&mut memory));
    let shared = &shared;
    let speed = signal("wheel_speed_mps");
    std::thread::scope(|scope| {
        for thread in 0..3 {
            scope.spawn(move || {
                for turn in 0..if cfg!(miri) { 20 } else { 20_000 } {
                    let mut live = LiveEstimate::default();
                    // SAFETY: as above.
                    let statuses = unsafe {
                        [
                            grade_on_reading(shared.0, turn * 100_000, speed, 10.0),
                            grade_step(shared.0),
                            grade_live(shared.0, &mut live),
                        ]
                    };
                    for status in statuses {
                        let is_documented =
                            matches!(status, Status::Ok | Status::Nothing | Status::Busy);
                        assert!(is_documented, "thread {thread}: {status:?}");
                    }
                }
            });
        }
    });
    // SAFETY: as above; all threads ended.
    assert_eq!(unsafe { grade_release(shared.0) }, Status::Ok);
}

#[test]
fn sizes_and_version_are_those_of_the_header() {
    assert!(grade_estimator_bytes() <= GRADE_ESTIMATOR_BYTES);
    // SAFETY: it is a static text that ends with zero.
    let version = unsafe { core::ffi::CStr::from_ptr(grade_version()) };
    assert_eq!(version.to_str(), Ok(env!("CARGO_PKG_VERSION")));
}
