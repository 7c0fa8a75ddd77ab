//! Estimates of recorded and simulated drives, and `roadgrade estimate`.

mod cell_ranges;
mod changed_resistance;
mod consistency;
mod end_to_end;
mod engine_configuration;
mod faulty_drive;
mod gnss_faults;
mod innovations;
mod late_receiver;
mod latencies;
mod mdf_signals;
mod motor_torque;
mod own_signals;
mod persistent_state;
mod placed_samples;
mod receiver_filters;
mod reversing;
mod smoothing;
mod sparse_altitudes;
mod stops_and_brakes;
mod torque_readings;
mod unreported_brake;
mod unreported_load;
