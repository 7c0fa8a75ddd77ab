//! The speed of the estimator, beside other programs that do the same work.
//!
//! * [`single`], [`double`]: the filters of `tests/peers` in either precision;
//! * [`stopwatch`]: times one filter;
//! * [`work`]: the work of a host on a drive;
//! * [`table`]: figures of one run, with their ratios.
//!
//! `benches/` has the same for criterion. `src/bin/beside.rs` runs all contenders in turns, so that
//! other load on the machine affects them alike. It prints the table of `docs/results.md`.

pub mod double;
pub mod single;
pub mod stopwatch;
pub mod table;
pub mod work;

/// A filter.
pub struct Contender<M> {
    /// Its name. The estimator's is "ours".
    pub name: &'static str,
    /// Number of its states.
    pub states: usize,
    /// Measures it.
    pub measure: fn(&mut M),
}
