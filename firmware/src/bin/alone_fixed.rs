//! The estimator in fixed point and nearly nothing else, to be measured (`firmware::alone`).

#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(target_os = "none")]
#[cortex_m_rt::entry]
fn main() -> ! {
    use estimator_core::{Estimator, FixedPoint};
    use static_cell::StaticCell;

    static ESTIMATOR: StaticCell<Estimator<FixedPoint>> = StaticCell::new();
    firmware::alone::run(&ESTIMATOR);
    firmware::wait()
}

firmware::ending!(silent);
