//! From drives to what the vehicle model lacks: residual, effect, vehicle file, and the error before
//! and after on drives that were not used.
//!
//! * [`drive`]: a log as it is seen here, and where its cells lie on a common road;
//! * [`candidates`]: what is tried: effects ([`estimator_core::effect::Search`]) and plain dependences
//!   ([`dependence`]); [`evidence`]: what drives say about it; [`regression`]: amounts
//!   and likelihoods from that; [`selection`]: what is adopted; [`search`]: these, one after the
//!   other;
//! * [`radius`]: wheels, which show in speed and distance rather than in slope;
//! * [`judgement`]: the bare model against a reference, before and after;
//! * [`diagnosis`]: all of it; [`findings`]: what it finds;
//! * [`picture`]: what stays unexplained, drawn; [`report`]: report.json and the page.

pub mod bare_model;
pub mod candidates;
pub mod dependence;
pub mod diagnosis;
pub mod drive;
pub mod evidence;
pub mod findings;
pub mod judgement;
pub mod picture;
pub mod radius;
pub mod regression;
pub mod report;
pub mod search;
pub mod selection;

pub use diagnosis::diagnose;
pub use findings::{CandidateCase, Diagnosis, Finding, Request, Unexplained};
