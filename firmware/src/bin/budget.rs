//! Counts the cost of the estimator on the emulated board, in each scalar type.
//!
//! It needs an emulator that counts instructions (`-icount`, see `firmware::meter`). This command
//! starts the emulator and shows the figures:
//!
//! ```text
//! cargo run -p cross-tests --release --example budgets
//! ```
//!
//! Exit status: 0 success, 1 an error, 101 a panic of the image.

#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(target_os = "none")]
#[cortex_m_rt::entry]
fn main() -> ! {
    semihosting::process::exit(match count() {
        Ok(()) => 0,
        Err(problem) => {
            semihosting::eprintln!("{problem}");
            1
        }
    })
}

/// Prints the figures of each scalar type under its name.
#[cfg(target_os = "none")]
fn count() -> Result<(), firmware::counted::BudgetError> {
    use estimator_core::{Estimator, FixedPoint};
    use firmware::budget::run;
    use firmware::memory_budget::FLASH_BYTES;
    use firmware::meter::InstructionMeter;
    use static_cell::StaticCell;

    static SINGLE: StaticCell<Estimator<f32>> = StaticCell::new();
    static FIXED: StaticCell<Estimator<FixedPoint>> = StaticCell::new();
    static FLASH: StaticCell<[u8; FLASH_BYTES]> = StaticCell::new();
    let flash = FLASH.init([0; FLASH_BYTES]);
    let mut meter = InstructionMeter::new()?;
    semihosting::print!("[f32]\n{}", run(&mut meter, &SINGLE, flash)?);
    semihosting::print!("[fixed]\n{}", run(&mut meter, &FIXED, flash)?);
    Ok(())
}

firmware::ending!(reported);
