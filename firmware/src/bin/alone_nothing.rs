//! What any image has, to be measured (`firmware::alone`): it starts, and that is all.

#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(target_os = "none")]
#[cortex_m_rt::entry]
fn main() -> ! {
    firmware::wait()
}

firmware::ending!(silent);
