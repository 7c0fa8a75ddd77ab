//! The estimator in `f32` and nearly nothing else, to be measured (`firmware::alone`).

#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(target_os = "none")]
#[cortex_m_rt::entry]
fn main() -> ! {
    use estimator_core::Estimator;
    use static_cell::StaticCell;

    static ESTIMATOR: StaticCell<Estimator<f32>> = StaticCell::new();
    firmware::alone::run(&ESTIMATOR);
    firmware::wait()
}

firmware::ending!(silent);
