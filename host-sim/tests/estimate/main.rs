//! Estimates of recorded and simulated drives, and `roadgrade estimate`.

mod consistency;
mod end_to_end;
mod gnss_faults;
mod persistent_state;
mod smoothing;
mod stops_and_brakes;
