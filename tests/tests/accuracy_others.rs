//! The estimator is as accurate as `tests/accuracy.csv` says: the drives of other simulators and the
//! measured vehicles that `accuracy` leaves out.

use cross_tests::accuracy::check;
use cross_tests::accuracy::subject::OTHERS;

#[test]
fn errors_are_those_committed() {
    let worse = check(OTHERS).unwrap();
    assert!(worse.is_empty(), "{worse}");
}
