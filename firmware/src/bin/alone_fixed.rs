//! The estimator in fixed point and next to nothing else, to be measured (`firmware::alone`).

#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(target_os = "none")]
#[cortex_m_rt::entry]
fn main() -> ! {
    use estimator_core::{Estimator, Fixed};
    use static_cell::StaticCell;

    static ESTIMATOR: StaticCell<Estimator<Fixed>> = StaticCell::new();
    firmware::alone::run(&ESTIMATOR);
    loop {
        cortex_m::asm::wfi();
    }
}

#[cfg(target_os = "none")]
#[panic_handler]
fn panicked(_: &core::panic::PanicInfo<'_>) -> ! {
    loop {
        cortex_m::asm::wfi();
    }
}

/// Lets `cargo build --workspace` and editors through on a host.
#[cfg(not(target_os = "none"))]
fn main() {
    eprintln!("this is an image for a board: build it with --target thumbv7em-none-eabihf");
    std::process::exit(2);
}
