//! Evidence for those who must judge the estimator: requirements and the tests that hold them, bounds
//! from the linked image, and reasons for what tests do not reach. `docs/evidence.md` says what there
//! is.

#![warn(missing_docs)]

pub mod call_graph;
pub mod calls;
pub mod exceptions;
pub mod files;
pub mod pages;
pub mod requirements;
pub mod test_functions;
