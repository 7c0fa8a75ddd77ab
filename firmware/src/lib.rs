//! What the images of several boards share: no estimator logic of its own.
//!
//! * [`exchange`]: the files that an emulated board and a host exchange; builds everywhere;
//! * `recorded`: a drive out of such a file; `replay`: it through the estimator; `budget`: what
//!   that costs, counted by `meter`; only on emulated boards;
//! * `alone`: the estimator and next to nothing else, to see what it adds to an image;
//! * [`ending!`]: how an image ends, on a board and on a host.

#![no_std]
#![warn(missing_docs)]

#[cfg(target_os = "none")]
pub mod alone;
#[cfg(target_os = "none")]
pub mod budget;
pub mod exchange;
#[cfg(target_os = "none")]
pub mod meter;
#[cfg(target_os = "none")]
pub mod recorded;
#[cfg(target_os = "none")]
pub mod replay;

/// Waits for ever.
#[cfg(target_os = "none")]
pub fn wait() -> ! {
    loop {
        cortex_m::asm::wfi();
    }
}

/// How an image ends: by a panic that is `told`, with exit status 101, or `silent`; and on a host,
/// where it is none, so that `cargo build --workspace` and editors get through.
#[macro_export]
macro_rules! ending {
    (told) => {
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
