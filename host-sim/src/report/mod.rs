//! Plots and the page that shows them.

pub mod page;
pub mod plan;
pub mod plot;
