//! How fast it is, beside others that do the same work.
//!
//! * [`single`], [`double`]: the filters of `tests/peers` in either precision;
//! * [`stopwatch`]: one of them, timed;
//! * [`work`]: what a host does with a drive;
//! * [`table`]: figures of one run, with their ratios.
//!
//! `benches/` has all of it for criterion; `src/bin/beside.rs` lets everybody take turns, so that
//! whatever else the machine does hits all alike, and writes the table of `docs/results.md`.

pub mod double;
pub mod single;
pub mod stopwatch;
pub mod table;
pub mod work;

/// A filter.
pub struct Contender<M> {
    /// Its name; the estimator's is "ours".
    pub name: &'static str,
    /// Number of its states.
    pub states: usize,
    /// Lets it be measured.
    pub measure: fn(&mut M),
}
