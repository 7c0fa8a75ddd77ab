//! The simulator: roads, trucks, buses and the GNSS error chain.

mod bus;
mod end_to_end;
mod gps_chain;
mod inertial;
mod manoeuvres;
mod physics;
mod planted_effects;
