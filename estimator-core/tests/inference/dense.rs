//! Forward and backward pass against dense matrices.

use crate::cells::{any_cell, first};
use estimator_core::filter::{CellInput, Covariance, Quantity, Record, STATES, State, StateIndex};
use estimator_core::inference::round::Memory;
use estimator_core::inference::{
    CellModel, CellVariances, DoubtCell, Levels, Numbers, Round, SEGMENT_CELLS, SegmentVariances,
    Stretch,
};
use nalgebra::{DMatrix, DVector};
use proptest::prelude::*;

fn dense(covariance: &Covariance<f64>) -> DMatrix<f64> {
    DMatrix::from_fn(STATES, STATES, |i, j| {
        covariance.get(StateIndex::ALL[i], StateIndex::ALL[j])
    })
}

/// The variances of a short stretch, in which forces are in doubt now and then.
fn variances(cells: &[CellInput]) -> (Vec<CellVariances>, Vec<SegmentVariances>) {
    let numbers = Numbers::default();
    let own = (0..cells.len()).map(|index| CellVariances {
        doubt: if index % 5 == 1 { 0.04 } else { 0.0 },
        doubt_cell: DoubtCell {
            is_on: index % 5 != 0,
            renews: false,
            step_percent: 0.1,
        },
        ..CellVariances::START
    });
    let segments = cells.len().div_ceil(SEGMENT_CELLS);
    (
        own.collect(),
        vec![SegmentVariances::start(&numbers, 1.0); segments],
    )
}

/// Runs a round and returns the records, and mean and variance of a quantity of each cell, smoothed.
fn smoothed(
    cells: &[CellInput],
    quantity: Quantity,
    block: usize,
) -> (Vec<Record<f64>>, Vec<(f64, f64)>) {
    let numbers = Numbers::default();
    let (mut own, mut segments) = variances(cells);
    let round = Round {
        model: CellModel::new(&numbers),
        levels: Levels::ONE,
        infers: false,
        leaving: 0,
    };
    let start = State::at_start(&numbers, &cells[0], 0.3);
    let mut stretch = Stretch {
        cells,
        own: &mut own,
        segments: &mut segments,
    };
    let mut memory = Memory {
        checkpoints: &mut vec![State::ZERO; cells.len().div_ceil(block)],
        records: &mut vec![Record::EMPTY; block],
    };
    let mut records = vec![Record::EMPTY; cells.len()];
    let mut estimates = vec![(0.0, 0.0); cells.len()];
    round.run(
        &start,
        &mut stretch,
        &mut memory,
        |index, record, adjoint| {
            let of = adjoint.smooth(&record.state, quantity);
            records[index] = *record;
            estimates[index] = (of.mean, of.variance);
        },
    );
    (records, estimates)
}

/// Returns the inverse of a covariance in which some states are known exactly: there it is zero.
fn inverse(covariance: &DMatrix<f64>) -> DMatrix<f64> {
    let uncertain: Vec<usize> = (0..STATES)
        .filter(|i| covariance[(*i, *i)] > 1e-9)
        .collect();
    let sigma = |at: usize| covariance[(uncertain[at], uncertain[at])].sqrt();
    let count = uncertain.len();
    let correlation = DMatrix::from_fn(count, count, |i, j| {
        covariance[(uncertain[i], uncertain[j])] / (sigma(i) * sigma(j))
    });
    let inverted = correlation.try_inverse().unwrap();
    let mut inverse = DMatrix::zeros(STATES, STATES);
    for i in 0..count {
        for j in 0..count {
            inverse[(uncertain[i], uncertain[j])] = inverted[(i, j)] / (sigma(i) * sigma(j));
        }
    }
    inverse
}

/// Smooths by the recursion of Rauch, Tung and Striebel with dense matrices.
fn dense_smoothed(
    cells: &[CellInput],
    records: &[Record<f64>],
    quantity: Quantity,
) -> Vec<(f64, f64)> {
    let numbers = Numbers::default();
    let (own, segments) = variances(cells);
    let model = CellModel::new(&numbers);
    let last = records.len() - 1;
    let filtered = |k: usize| {
        let state = &records[k].state;
        (
            DVector::from_row_slice(&state.mean),
            dense(&state.covariance),
        )
    };
    let (mut mean, mut covariance) = filtered(last);
    let mut estimates = vec![(0.0, 0.0); records.len()];
    for k in (0..=last).rev() {
        if k < last {
            let (x, p) = filtered(k);
            // F, Q and the input of the next cell, from steps without measurements.
            let next = CellInput {
                energy: estimator_core::filter::Reading::NONE,
                altitude: estimator_core::filter::Reading::NONE,
                ..cells[k + 1]
            };
            let segment = &segments[(k + 1) / SEGMENT_CELLS];
            let begins = (k + 1) % SEGMENT_CELLS == 0;
            let terms = model.terms::<f64>(&next, &own[k + 1], segment, begins, &Levels::ONE);
            let step = |mean: &DVector<f64>, covariance: Covariance<f64>| {
                let mut state = State {
                    mean: std::array::from_fn(|i| mean[i]),
                    covariance,
                    ..records[k].state
                };
                let mut record = Record::EMPTY;
                state.step(&next, &terms.dynamics, &terms.noise, None, &mut record);
                state
            };
            let predicted = step(&x, records[k].state.covariance);
            let noise = dense(&step(&x, Covariance::ZERO).covariance);
            let mut f = DMatrix::zeros(STATES, STATES);
            for i in 0..STATES {
                let mut moved = x.clone();
                moved[i] += 1.0;
                let column = DVector::from_row_slice(&step(&moved, Covariance::ZERO).mean)
                    - DVector::from_row_slice(&predicted.mean);
                f.set_column(i, &column);
            }
            let of_predicted = dense(&predicted.covariance);
            // The packed step is F P F' + Q.
            let product = &f * &p * f.transpose() + noise;
            assert!((&product - &of_predicted).amax() < 1e-7 * (1.0 + product.amax()));
            let gain = &p * f.transpose() * inverse(&of_predicted);
            mean = &x + &gain * (mean - DVector::from_row_slice(&predicted.mean));
            covariance = &p + &gain * (covariance - of_predicted) * gain.transpose();
        }
        let state = State {
            mean: std::array::from_fn(|i| mean[i]),
            ..records[k].state
        };
        let (of, _) = state.quantity(quantity);
        let row = DVector::from_fn(STATES, |i, _| {
            let mut unit = State {
                net_traction: state.net_traction,
                retarder: state.retarder,
                ..State::<f64>::ZERO
            };
            unit.mean[i] = 1.0;
            unit.quantity(quantity).0.mean
        });
        let variance = (row.transpose() * &covariance * row)[0];
        estimates[k] = (of.mean, variance);
    }
    estimates
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(32))]

    #[test]
    fn smoothing_is_that_of_dense_matrices(cells in prop::collection::vec(any_cell(), 12..30)) {
        let mut cells = cells;
        cells.insert(0, first());
        for quantity in [Quantity::RoadSlope, Quantity::Altitude, Quantity::ModelError, Quantity::Scale] {
            let (records, ours) = smoothed(&cells, quantity, 64);
            // No step of the speed's sensor, which dense matrices do not know.
            prop_assume!(!records.iter().any(|record| record.speed_steps));
            let dense = dense_smoothed(&cells, &records, quantity);
            for ((mean, variance), (dense_mean, dense_variance)) in ours.into_iter().zip(dense) {
                let sigma = dense_variance.max(1e-12).sqrt();
                prop_assert!((mean - dense_mean).abs() < 1e-3 * sigma + 1e-7, "{quantity:?}: {mean} {dense_mean}");
                prop_assert!((variance - dense_variance).abs() < 1e-3 * dense_variance + 1e-9, "{quantity:?}: {variance} {dense_variance}");
            }
        }
    }

    #[test]
    fn blocks_change_nothing(cells in prop::collection::vec(any_cell(), 30..90), block in 3usize..40) {
        let mut cells = cells;
        cells.insert(0, first());
        let (_, whole) = smoothed(&cells, Quantity::RoadSlope, 128);
        let (_, in_blocks) = smoothed(&cells, Quantity::RoadSlope, block);
        prop_assert_eq!(whole, in_blocks);
    }
}
