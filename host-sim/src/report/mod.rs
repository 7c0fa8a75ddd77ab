//! Plots and the page that shows them.

pub mod page;
pub mod plot;
