//! The thesis's methods, tables and figures.

mod convergence;
mod experiments;
mod filters;
mod sensitivity;
mod simulated_drives;
mod studies;
