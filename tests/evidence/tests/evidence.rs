//! The evidence is complete: requirements and tests name each other, and what tests do not reach has
//! a reason.

use evidence::calls::{CallBounds, committed_calls};
use evidence::exceptions::{Coverage, Mutants};
use evidence::files::source;
use evidence::pages::pages;
use evidence::requirements::Requirements;

#[test]
fn every_requirement_has_tests_and_every_test_of_the_core_a_requirement() {
    let requirements = Requirements::read().unwrap();
    assert!(requirements.iter().count() > 40);
    let problems = requirements.problems().unwrap();
    assert!(problems.is_empty(), "{}", problems.join("\n"));
}

#[test]
fn the_generated_parts_of_pages_are_current() {
    for page in pages().unwrap() {
        let how = "cargo run -p evidence -- requirements --write";
        let path = page.path.display();
        assert!(
            page.current == page.committed,
            "{path}: make it again: {how}"
        );
    }
}

#[test]
fn every_exception_has_a_line_and_a_reason() {
    let mut problems = Coverage::read().unwrap().problems().unwrap();
    problems.extend(Mutants::read().unwrap().problems());
    assert!(problems.is_empty(), "{}", problems.join("\n"));
}

#[test]
fn every_committed_call_is_within_its_limits() {
    let committed = CallBounds::read(&committed_calls()).unwrap();
    assert!(committed.calls.len() > 10, "{committed:#?}");
    let excesses = committed.excesses(&committed);
    assert!(excesses.is_empty(), "{}", excesses.join("\n"));
}

#[test]
fn nothing_was_measured_above_its_bound() {
    let committed = CallBounds::read(&committed_calls()).unwrap();
    let budgets = source("firmware/budgets.csv").unwrap();
    let below = committed.below_measured(&budgets).unwrap();
    assert!(below.is_empty(), "{}", below.join("\n"));
}
