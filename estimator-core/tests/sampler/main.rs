//! The sampler: readings become samples.

mod effect_inputs;
mod measured_ratio;
mod model_validity;
mod receiver_timing;
mod reversing;
mod shaft_torque;
mod stops;
