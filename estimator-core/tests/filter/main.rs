//! The filter: its states, its solution, its statistics, its gates.

mod accelerometer;
mod altitude_delay;
mod altitude_gate;
mod batch;
mod bias_step;
#[cfg(feature = "fixed")]
mod fixed_point_drive;
mod gross_mass;
mod independent_solutions;
mod late_traction;
mod loads;
mod model_doubt;
mod prediction;
mod scale_bounds;
mod silent_brake;
mod slopes;
mod states;
mod statistics;
mod unknown_forces;
