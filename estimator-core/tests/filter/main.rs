//! The filter on samples: the mass, sensors on the body, and a receiver with a low-pass.

mod gross_mass;
mod receiver_low_pass;
mod sensors;
