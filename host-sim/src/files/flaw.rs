//! What is wrong with a row.

use std::fmt;

/// A problem of a row.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Flaw {
    /// The problem.
    pub problem: String,
    /// The expected value.
    pub expected: &'static str,
}

impl fmt::Display for Flaw {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}; expected {}", self.problem, self.expected)
    }
}
