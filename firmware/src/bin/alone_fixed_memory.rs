//! The estimator in fixed point with a road memory and nearly nothing else, to be measured
//! (`firmware::alone`).

#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(target_os = "none")]
#[cortex_m_rt::entry]
fn main() -> ! {
    use estimator_core::{Estimator, FixedPoint};
    use firmware::alone::{AloneMemory, run_with_memory};
    use static_cell::StaticCell;

    static ESTIMATOR: StaticCell<Estimator<FixedPoint>> = StaticCell::new();
    static MEMORY: StaticCell<AloneMemory> = StaticCell::new();
    run_with_memory(&ESTIMATOR, &MEMORY);
    firmware::wait()
}

firmware::ending!(silent);
