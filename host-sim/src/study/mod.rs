//! Tables and figures: one file a study.
//!
//! A study is a function from [`Setting`] to a [`Section`](crate::report::page::Section) of the
//! report. Its tables and figures are files beside the page. A new study takes a file and a line in
//! [`STUDIES`].

pub mod accuracy;
pub mod alignment;
pub mod bridges;
pub mod convergence;
mod definition;
pub mod distance_drive;
pub mod drift;
mod drive_errors;
pub mod e4;
pub mod experiments;
pub mod fleet;
pub mod gps;
pub mod i3;
pub mod known_road;
pub mod sensitivity;
pub mod sensors;
pub mod shared_errors;
pub mod track;
pub mod windows;
pub mod ztbus;

pub use definition::{Setting, Study, StudyOutcome};

/// Every study, in the order of the report.
pub const STUDIES: &[Study] = &[
    sensitivity::STUDY,
    experiments::pointwise::STUDY,
    gps::STUDY,
    convergence::STUDY,
    experiments::model_errors::STUDY,
    experiments::tuning::STUDY,
    experiments::modified::STUDY,
    experiments::campaigns::STUDY,
    e4::STUDY,
    accuracy::STUDY,
    sensors::STUDY,
    fleet::STUDY,
    alignment::STUDY,
    shared_errors::STUDY,
    bridges::STUDY,
    ztbus::STUDY,
    track::STUDY,
    i3::STUDY,
];
