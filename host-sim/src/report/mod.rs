//! Plots and pages.
//!
//! A [`page`] is one file that works offline: sections of text, notes, tables, charts and plans.
//! Charts and plans can be hovered and zoomed; those with the same link show the same place.
//! Tables and plots are also written beside the page as CSV and SVG.
//!
//! ```
//! use host_sim::report::page::{Figure, Note, Page, Section, Table};
//! use host_sim::report::plan::{Colouring, Plan, PlanLine, PlanPoint};
//! use host_sim::report::plot::{Plot, colour};
//! use host_sim::report::profile::ProfilePoint;
//!
//! let cells = [(0.0, 59.3500, 18.0, 1.2), (2.5, 59.3501, 18.0, 1.3)];
//! let profile = Plot::profile("grade (%)", "road").with_profile(
//!     "map",
//!     colour::BLUE,
//!     cells.map(|(distance_m, _, _, value)| ProfilePoint { distance_m, value, sigma: Some(0.05) }),
//! );
//! let plan = Plan {
//!     colourings: vec![Colouring::grades(cells.map(|cell| cell.3))],
//!     lines: vec![PlanLine {
//!         name: "map".to_owned(),
//!         link: "road".to_owned(), // hover in one shows the place in the other
//!         points: cells
//!             .map(|(distance_m, latitude_deg, longitude_deg, grade_percent)| PlanPoint {
//!                 latitude_deg,
//!                 longitude_deg,
//!                 distance_m,
//!                 values: vec![grade_percent],
//!             })
//!             .into(),
//!     }],
//! };
//! let assumed = Table::new("vehicle", "What was assumed.", &["key", "value", "origin"])
//!     .with_rows([vec!["mass_kg".to_owned(), "39000".to_owned(), "read".to_owned()]]);
//! let page = Page::new("Map of two cells", "From one log.")
//!     .with(
//!         Section::new("The road")
//!             .paragraph("Grade in the direction of travel.")
//!             .figure(Figure::plan("plan", plan, "Plan."))
//!             .figure(Figure::new("grade", &profile, "Grade along the road.")),
//!     )
//!     .with(
//!         Section::new("The vehicle")
//!             .note(Note::warning("torque never passes 1 %", "check its unit"))
//!             .table(assumed),
//!     );
//! let folder = tempfile::tempdir().unwrap();
//! let file = page.write(folder.path()).unwrap(); // report.html, grade.svg, grade.csv, vehicle.csv
//! page.stage_alone(&folder.path().join("index.html")).unwrap().commit().unwrap(); // one file
//! # assert!(file.ends_with("report.html"));
//! ```

mod assets;
pub mod chart_data;
pub mod colour;
mod colouring;
pub mod demo_page;
mod digits;
pub mod figure;
pub mod logs_page;
pub mod map_page;
pub mod on_map;
pub mod page;
pub mod plan;
pub mod plot;
pub mod profile;
pub mod section;
mod svg;
pub mod table;
pub mod thin;
pub mod verdict;
