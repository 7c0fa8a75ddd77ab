//! What measured drives say: errors over windows, drift of the bare vehicle model.

pub mod drift;
pub mod windows;
pub mod ztbus;
