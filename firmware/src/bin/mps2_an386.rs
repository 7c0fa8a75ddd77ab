//! The emulated board: a Cortex-M4F whose files and console are QEMU's.
//!
//! In a folder with a `drive.bin` (see [`firmware::exchange`]), with the workspace's manifest:
//!
//! ```text
//! cargo run -p firmware --profile dist --target thumbv7em-none-eabihf
//! ```
//!
//! It logs with defmt on stdout, for `defmt-print -e IMAGE`. The example `emulate` of `cross-tests`
//! does all of this for a log. Exit status: 0 success, 1 an error, 101 a panic of the image. The
//! reason is on stderr.

#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(target_os = "none")]
use defmt_semihosting as _;

#[cfg(target_os = "none")]
#[cortex_m_rt::entry]
fn main() -> ! {
    semihosting::process::exit(match firmware::replay::run() {
        Ok(()) => 0,
        Err(problem) => {
            semihosting::eprintln!("{problem}");
            1
        }
    })
}

firmware::ending!(reported);
