//! States: their order, and their vectors and matrices in nalgebra's types.

#[cfg(feature = "fixed")]
use estimator_core::FixedPoint;
use estimator_core::filter::{Covariance, STATES, State, StateIndex, StateVector};
use estimator_core::{Scalar, Tuning};
use nalgebra::{SMatrix, SVector};
use test_kit::{FilterRun, altitude, run, sample, speed, truck};

#[test]
fn all_states_are_in_the_order_of_their_numbers() {
    assert_eq!(StateIndex::ALL.len(), STATES);
    for (position, state) in StateIndex::ALL.into_iter().enumerate() {
        assert_eq!(state as usize, position, "{state:?}");
    }
}

/// Returns the vector of a dense one.
fn vector<S: Scalar + nalgebra::Scalar>(dense: &SVector<S, STATES>) -> StateVector<S> {
    let mut vector = StateVector::ZERO;
    for state in StateIndex::ALL {
        vector[state] = dense[state as usize];
    }
    vector
}

/// Returns the covariance of a dense matrix, read from its upper or from its lower triangle.
fn covariance<S: Scalar + nalgebra::Scalar>(
    dense: &SMatrix<S, STATES, STATES>,
    upper: bool,
) -> Covariance<S> {
    let mut covariance = Covariance::ZERO;
    for (i, row) in StateIndex::ALL.into_iter().enumerate() {
        for column in StateIndex::ALL.into_iter().skip(i) {
            let (row_at, column_at) = (row as usize, column as usize);
            let element = if upper {
                dense[(row_at, column_at)]
            } else {
                dense[(column_at, row_at)]
            };
            covariance.set(row, column, element);
        }
    }
    covariance
}

fn assert_round_trip<S: Scalar + nalgebra::Scalar>(mean: &StateVector<S>, matrix: &Covariance<S>) {
    let (dense_mean, dense) = (mean.to_nalgebra(), matrix.to_nalgebra());
    assert_eq!(vector(&dense_mean), *mean);
    assert_eq!(mean.as_array(), dense_mean.as_slice());
    for upper in [true, false] {
        assert_eq!(covariance(&dense, upper), *matrix);
    }
    for i in StateIndex::ALL {
        assert_eq!(dense_mean[i as usize], mean[i], "{i:?}");
        for j in StateIndex::ALL {
            assert_eq!(
                dense[(i as usize, j as usize)],
                matrix.get(i, j),
                "{i:?} {j:?}"
            );
        }
    }
}

/// Returns a state in which every element differs from every other one.
fn numbered<S: Scalar>() -> (StateVector<S>, Covariance<S>) {
    let mut numbers = (1_u8..).map(|number| S::from_f32(f32::from(number) - 0.25));
    let mut number = || numbers.next().unwrap();
    let (mut mean, mut matrix) = (StateVector::ZERO, Covariance::ZERO);
    for (i, row) in StateIndex::ALL.into_iter().enumerate() {
        mean[row] = number();
        for column in StateIndex::ALL.into_iter().skip(i) {
            matrix.set(row, column, number());
        }
    }
    (mean, matrix)
}

/// Returns the state after a short drive.
fn driven<S: Scalar>() -> State<S> {
    let samples: Vec<_> = (1..=60_u16)
        .map(|cell| {
            let mut sample = sample(cell.into(), 9_000.0, 20.0);
            sample.speed = speed(20.0);
            sample.altitude = altitude(100.0 + 0.02 * f32::from(cell));
            sample
        })
        .collect();
    run(&samples, &Tuning::default()).last().unwrap().state
}

fn assert_round_trips<S: Scalar + nalgebra::Scalar>() {
    let (mean, matrix) = numbered::<S>();
    assert_round_trip(&mean, &matrix);
    let State {
        mean, covariance, ..
    } = driven::<S>();
    // Every state is known with some uncertainty, and most are correlated.
    assert!(
        StateIndex::ALL
            .iter()
            .all(|i| covariance.variance(*i) > S::ZERO)
    );
    assert_round_trip(&mean, &covariance);
}

#[test]
fn single_precision_survives_the_dense_form() {
    assert_round_trips::<f32>();
}

#[test]
fn a_state_in_another_number_type_is_the_nearest_one() {
    let wide: State<f64> = driven();
    let narrow: State<f32> = wide.cast();
    assert_eq!(narrow.origin_m, wide.origin_m);
    assert_eq!(narrow.net_traction, wide.net_traction as f32);
    for i in StateIndex::ALL {
        assert_eq!(narrow.mean[i], wide.mean[i] as f32, "{i:?}");
        for j in StateIndex::ALL {
            let element = wide.covariance.get(i, j) as f32;
            assert_eq!(narrow.covariance.get(i, j), element, "{i:?} {j:?}");
        }
    }
    // What is narrow already does not change.
    let back: State<f32> = narrow.cast::<f64>().cast();
    assert_eq!(back, narrow);
}

#[cfg(feature = "fixed")]
#[test]
fn fixed_point_survives_the_dense_form() {
    assert_round_trips::<FixedPoint>();
}

#[test]
fn before_the_first_speed_there_is_no_state() {
    let mut run = FilterRun::<f64>::new(truck(), Tuning::default());
    for cell in 1..=300 {
        let mut sample = sample(cell, 9_000.0, 20.0);
        // A brake over half a kilometre, and then none.
        sample.end.condition.braking = cell <= 200;
        assert_eq!(run.step(&sample), None, "{cell}");
    }
    let mut first = sample(301, 9_000.0, 20.0);
    first.speed = speed(20.0);
    assert!(run.step(&first).is_some());
    assert_eq!(run.context.counters.restarts, 0);
}
