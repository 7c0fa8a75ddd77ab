//! The C interface of the road-grade estimator.
//!
//! C programs link the static library and include `include/road_grade.h`, which is made of these
//! sources. docs/c.md says how. All memory is the caller's. Nothing allocates, blocks, calls back or
//! reads a clock.
//!
//! `unsafe` stands only where C's pointers come in. What can be checked is checked: null, alignment,
//! size, and whether the object was created here and is free (`slot`). What cannot is each function's
//! "Safety" section: that pointers lead where they say.
//!
//! | file | content |
//! |---|---|
//! | `estimator` | create, frames and readings in, step, estimates and state out |
//! | `map` | the packed map: live grade with it, and the grade ahead |
//! | `vehicle`, `estimate` | parameter block, results |
//! | `slot`, `pointer` | the caller's memory and pointers |
//! | `status` | what a call returns |

#![no_std]
#![warn(missing_docs)]

#[cfg(not(target_os = "none"))]
extern crate std;

pub mod estimate;
pub mod estimator;
mod frame;
pub mod map;
mod pointer;
mod slot;
pub mod status;
pub mod vehicle;

/// Waits forever. The estimator has no reachable panic: the linker removes this.
#[cfg(target_os = "none")]
#[panic_handler]
fn panicked(_: &core::panic::PanicInfo<'_>) -> ! {
    loop {
        core::hint::spin_loop();
    }
}
