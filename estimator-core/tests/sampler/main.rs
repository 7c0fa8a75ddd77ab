//! The sampler: readings become samples.

#[path = "../common/mod.rs"]
mod common;

mod effect_inputs;
mod model_validity;
mod stops;
