//! The estimator is as accurate as `tests/accuracy.csv` says: four drives of other simulators, and a
//! measured trip. `accuracy_others` has the others.

use cross_tests::accuracy::check;
use cross_tests::accuracy::subject::QUICK;

#[test]
fn errors_are_those_committed() {
    let worse = check(QUICK).unwrap();
    assert!(worse.is_empty(), "{worse}");
}
