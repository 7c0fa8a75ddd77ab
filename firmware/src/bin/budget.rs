//! Counts what the estimator costs on the emulated board, in each scalar.
//!
//! For an emulator that counts instructions (`-icount`, see `firmware::meter`); the command
//! that starts it so and shows the figures is
//!
//! ```text
//! cargo run -p cross-tests --release --example budgets
//! ```
//!
//! Exit status: 0 done, 1 it could not be done, 101 the image panicked.

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

/// Prints the figures of each scalar under its name.
#[cfg(target_os = "none")]
fn count() -> Result<(), firmware::budget::BudgetError> {
    use estimator_core::FixedPoint;
    use firmware::budget::run;
    use firmware::meter::InstructionMeter;

    let mut meter = InstructionMeter::new()?;
    semihosting::print!("[f32]\n{}", run::<f32>(&mut meter)?);
    semihosting::print!("[fixed]\n{}", run::<FixedPoint>(&mut meter)?);
    Ok(())
}

firmware::ending!(told);
