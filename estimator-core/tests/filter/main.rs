//! The filter on samples: the mass, and sensors on the body.

mod gross_mass;
mod sensors;
