//! Plots and pages.

pub mod demo_page;
pub mod logs_page;
pub mod map_page;
pub mod page;
pub mod plan;
pub mod plot;
