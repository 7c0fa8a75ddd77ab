//! Estimates of recorded and simulated drives, and `roadgrade estimate`.

#[path = "../simulated/mod.rs"]
mod simulated;

mod end_to_end;
mod gnss_faults;
mod persistent_state;
mod smoothing;
mod stops_and_brakes;
