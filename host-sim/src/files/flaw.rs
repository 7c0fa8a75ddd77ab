//! What is wrong with a row.

/// A problem of a row.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Flaw {
    /// The problem.
    pub problem: String,
    /// The expected value.
    pub expected: &'static str,
}
