//! The estimator in `f32` with a map and nearly nothing else, to be measured (`firmware::alone`).

#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(target_os = "none")]
#[cortex_m_rt::entry]
fn main() -> ! {
    use estimator_core::Estimator;
    use firmware::on_map::OnMap;
    use static_cell::StaticCell;

    static ESTIMATOR: StaticCell<Estimator<f32>> = StaticCell::new();
    static ON_MAP: StaticCell<OnMap<'static>> = StaticCell::new();
    firmware::alone::run_on_map(&ESTIMATOR, &ON_MAP);
    firmware::wait()
}

firmware::ending!(silent);
