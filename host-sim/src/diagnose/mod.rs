//! Diagnosis of the vehicle model: residual, effect, vehicle file, and the error before and after
//! on drives that were not fitted.
//!
//! * [`drive`]: a log as input, and the places of its cells on a common road;
//! * [`candidates`]: the candidates: effects ([`estimator_core::effect::Search`]) and plain
//!   dependences ([`dependence`]); `column_kind`: their forces;
//! * [`evidence`]: the sums of the drives for them; [`regression`]: amounts and likelihoods from
//!   these; [`case`]: the fit of one candidate; [`rivals`] and `pairs`: which one, or which two, to
//!   adopt; [`selection`]: forward and backward; [`search`]: all these steps;
//! * [`radius`]: the wheel radius, which shows in speed and distance rather than in slope;
//! * [`judgement`]: the bare model against a reference, before and after;
//! * [`signal_judgement`]: model and estimates against the accelerometer, which is evidence too;
//!   [`terrain_reference`]: terrain as a reference;
//!   `judge`: all of these, before and after;
//! * [`diagnosis`]: the whole procedure; `request_logs`: the logs to fit and to judge;
//!   [`findings`]: its request and result;
//! * [`picture`]: plots of unexplained dependences; [`report`]: report.json and the page.

mod accelerometer;
pub mod bare_model;
pub mod candidates;
pub mod case;
mod collector;
mod column_kind;
pub mod dependence;
pub mod diagnosis;
pub mod drive;
pub mod evidence;
pub mod findings;
mod fitter;
mod judge;
pub mod judgement;
mod pairs;
pub mod picture;
pub mod radius;
pub mod regression;
pub mod report;
mod request_logs;
pub mod rivals;
pub mod search;
pub mod selection;
pub mod signal_judgement;
pub mod terrain_reference;

pub use diagnosis::diagnose;
pub use findings::{CandidateCase, Diagnosis, Finding, Request, Unexplained};
