//! What is wrong with a row.

/// A problem of a row.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Flaw {
    /// What was found.
    pub problem: String,
    /// What was expected.
    pub expected: &'static str,
}
