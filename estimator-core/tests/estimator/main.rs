//! The facade: frames in, cells and frames out.

mod accelerometers;
mod ahead;
mod broadcast;
mod delays;
mod engine_configuration;
mod facade;
mod input_faults;
mod newer_messages;
mod whole_interface;
