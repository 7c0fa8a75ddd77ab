//! Plots, and the pages that show them.

pub mod map_page;
pub mod page;
pub mod plan;
pub mod plot;
