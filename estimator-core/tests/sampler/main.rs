//! The sampler: readings become samples.

mod effect_inputs;
mod model_validity;
mod stops;
