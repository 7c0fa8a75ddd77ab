//! Scripts and styles that every page carries, so that it works offline.

/// Plotting library: uPlot, third-party, MIT licence.
pub const UPLOT_JS: &str = include_str!("assets/uplot/uPlot.iife.min.js");
/// Its styles.
pub const UPLOT_CSS: &str = include_str!("assets/uplot/uPlot.min.css");
/// Its licence. Every copy must contain it.
pub const UPLOT_LICENCE: &str = include_str!("assets/uplot/LICENSE");
/// Styles of pages.
pub const PAGE_CSS: &str = include_str!("assets/page.css");
/// Hover and zoom that figures share.
pub const LINKS_JS: &str = include_str!("assets/links.js");
/// Charts.
pub const CHART_JS: &str = include_str!("assets/chart.js");
/// Plans.
pub const PLAN_JS: &str = include_str!("assets/plan.js");
/// Starts the figures of a page.
pub const START_JS: &str = include_str!("assets/start.js");
