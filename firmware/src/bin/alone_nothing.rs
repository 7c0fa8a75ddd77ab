//! An image that only starts, to measure the size of any image (`firmware::alone`).

#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(target_os = "none")]
#[cortex_m_rt::entry]
fn main() -> ! {
    firmware::wait()
}

firmware::ending!(silent);
