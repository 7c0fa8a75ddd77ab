//! What the estimator's numbers and mechanisms are worth, on drives of the accuracy guard: by how much
//! the errors change if a number is halved or doubled ([`numbers`]), and if a mechanism is off
//! ([`mechanisms`]).
//!
//! A change is that of the geometric mean over the [`drives`]: each drive counts as much as another, be its
//! error small or large.

mod at_once;
mod change;
pub mod mechanisms;
pub mod numbers;

pub use change::{Baseline, Change};

use crate::accuracy::subject::{OTHERS, QUICK, Subject};
use estimator_core::Tuning;
use estimator_core::tuning::TuningParameter;
use std::collections::BTreeMap;

/// Returns what is judged: the guard's drives but the trips of the measured car all together, which take
/// as long as the others.
pub fn drives() -> impl Iterator<Item = Subject> {
    let drives = QUICK.iter().chain(OTHERS).copied();
    drives.filter(|drive| *drive != Subject::Trips)
}

/// Returns the parameter of a key; `None` if there is none.
#[must_use]
pub fn parameter(key: &str) -> Option<&'static TuningParameter> {
    Tuning::PARAMETERS.iter().find(|of| of.key == key)
}

/// Returns one row for each of these names, in their order: the new one, else the committed one. What has
/// neither, or another name, is left out.
fn merged<R: Clone>(
    names: impl IntoIterator<Item = String>,
    new: &R,
    committed: &[R],
    name: impl Fn(&R) -> String,
) -> Vec<R> {
    let by_name: BTreeMap<String, &R> = committed
        .iter()
        .chain([new])
        .map(|row| (name(row), row))
        .collect();
    let rows = names.into_iter().filter_map(|name| by_name.get(&name));
    rows.map(|row| (*row).clone()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_new_row_takes_the_place_of_a_committed_one_and_others_stay() {
        let row = |name: &str, of| (name.to_owned(), of);
        let committed = [row("a", 1), row("gone", 2), row("c", 3)];
        let with = |new| {
            let names = ["a", "b", "c"].map(str::to_owned);
            merged(names, &new, &committed, |row| row.0.clone())
        };
        assert_eq!(with(row("a", 4)), [row("a", 4), row("c", 3)]);
        assert_eq!(with(row("b", 4)), [row("a", 1), row("b", 4), row("c", 3)]);
    }
}
