//! What is wrong with a line of a log.

/// Why a line is not of its format.
#[derive(Debug)]
pub(in crate::source) struct LineProblem {
    pub what: &'static str,
    pub expected: &'static str,
    /// True for a line that says how to read all others: without it the log cannot be read.
    pub is_header: bool,
}

pub(super) const fn problem(what: &'static str, expected: &'static str) -> LineProblem {
    LineProblem {
        what,
        expected,
        is_header: false,
    }
}

pub(super) const fn header_problem(what: &'static str, expected: &'static str) -> LineProblem {
    LineProblem {
        what,
        expected,
        is_header: true,
    }
}

pub(super) type Parsed<T> = Result<T, LineProblem>;
