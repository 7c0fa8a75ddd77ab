//! The sampler: readings become samples.

mod accelerometer;
mod effect_inputs;
mod measured_ratio;
mod model_validity;
mod positions;
mod receiver_timing;
mod reversing;
mod shaft_torque;
mod slope_sensors;
mod stops;
mod traction_timing;
