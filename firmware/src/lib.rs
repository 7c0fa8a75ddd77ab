//! The code that the images of several boards share. It has no estimator logic of its own.
//!
//! * [`on_map`]: the map beside the estimator; builds for every target, as do
//! * [`exchange`]: the files that an emulated board and a host exchange;
//! * `recorded` reads a drive from such a file, `replay` runs it through the estimator, `budget` and
//!   `memory_budget` count the cost with `meter`; only on emulated boards;
//! * `map_region` is where a map lies in flash;
//! * `alone`: the estimator and nearly nothing else, to measure what it adds to an image;
//! * `calls`: each call of the estimator as a function of its own, for the analysis of its call graph;
//! * [`ending!`]: the end of an image, on a board and on a host.

#![no_std]
#![warn(missing_docs)]

#[cfg(target_os = "none")]
pub mod alone;
#[cfg(target_os = "none")]
pub mod budget;
#[cfg(target_os = "none")]
pub mod calls;
#[cfg(target_os = "none")]
pub mod counted;
pub mod exchange;
#[cfg(target_os = "none")]
pub mod map_region;
#[cfg(target_os = "none")]
pub mod memory_budget;
#[cfg(target_os = "none")]
pub mod meter;
pub mod on_map;
#[cfg(target_os = "none")]
pub mod recorded;
#[cfg(target_os = "none")]
pub mod replay;

/// Waits forever.
#[cfg(target_os = "none")]
pub fn wait() -> ! {
    loop {
        cortex_m::asm::wfi();
    }
}

/// Defines the end of an image. A panic is `reported`, with exit status 101, or `silent`. On a
/// host, where the image cannot run, it defines a `main` so that `cargo build --workspace` and
/// editors work.
#[macro_export]
macro_rules! ending {
    (reported) => {
        $crate::ending!(info => {
            semihosting::eprintln!("{info}");
            semihosting::process::exit(101)
        });
    };
    (silent) => {
        $crate::ending!(_info => $crate::wait());
    };
    ($info:ident => $end:expr) => {
        #[cfg(target_os = "none")]
        #[panic_handler]
        fn panicked($info: &core::panic::PanicInfo<'_>) -> ! {
            $end
        }

        #[cfg(not(target_os = "none"))]
        fn main() {
            eprintln!("this is an image for a board: build it with --target thumbv7em-none-eabihf");
            std::process::exit(2);
        }
    };
}
