//! Each call of the estimator in `f32` as a function of its own, to be analysed (`firmware::calls`).

#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(target_os = "none")]
#[cortex_m_rt::entry]
fn main() -> ! {
    use estimator_core::Estimator;
    use static_cell::StaticCell;

    static ESTIMATOR: StaticCell<Estimator<f32>> = StaticCell::new();
    if let Some(place) = ESTIMATOR.try_uninit() {
        firmware::calls::run(place);
    }
    firmware::wait()
}

firmware::ending!(silent);
