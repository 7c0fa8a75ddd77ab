//! The scores of the backward pass are the derivatives of the likelihood.

use crate::cells::{any_cell, first};
use estimator_core::filter::{Adjoint, CellInput, CellNoise, Disturbances, Noise, Record, State};
use estimator_core::inference::{
    CellModel, CellVariances, DoubtCell, Levels, Numbers, SegmentVariances,
};
use proptest::prelude::*;

/// A noise whose variance is changed.
#[derive(Clone, Copy, Debug)]
enum Changed {
    Of(Noise),
    Load,
    Speed,
    Altitude,
}

fn place(noise: &mut CellNoise<f64>, changed: Changed) -> &mut f64 {
    match changed {
        Changed::Of(of) => &mut noise.of[of as usize],
        Changed::Load => &mut noise.load,
        Changed::Speed => &mut noise.speed,
        Changed::Altitude => &mut noise.altitude,
    }
}

struct Passed {
    speed_steps: bool,
    log_likelihood: f64,
    found: Vec<Disturbances<f64>>,
    noise: CellNoise<f64>,
}

/// Passes forward and back, with one variance of one cell changed by an amount.
fn pass(cells: &[CellInput], at: usize, changed: Changed, by: f64) -> Passed {
    let numbers = Numbers::default();
    let model = CellModel::new(&numbers);
    let segment = SegmentVariances::start(&numbers, 1.0);
    let own = CellVariances {
        doubt: 0.02,
        doubt_cell: DoubtCell {
            is_on: true,
            renews: false,
            step_percent: 0.1,
        },
        ..CellVariances::START
    };
    let mut state = State::<f64>::at_start(&numbers, &cells[0], 0.3);
    let mut records = Vec::new();
    let mut log_likelihood = 0.0;
    let mut changed_noise = None;
    for (k, cell) in cells.iter().enumerate() {
        let mut terms = model.terms::<f64>(cell, &own, &segment, k == 0, &Levels::ONE);
        if k == at {
            *place(&mut terms.noise, changed) += by;
            changed_noise = Some(terms.noise);
        }
        let mut record = Record::EMPTY;
        if cell.marks.gap {
            state.start(&numbers, cell, &terms.noise, 1.0, None, &mut record);
        } else {
            state.step(cell, &terms.dynamics, &terms.noise, None, &mut record);
        }
        for update in [&record.speed, &record.altitude].into_iter().flatten() {
            let variance = update.innovation_variance;
            log_likelihood -= 0.5 * (update.innovation.powi(2) / variance + variance.ln());
        }
        records.push((record, terms));
    }
    let mut adjoint = Adjoint::NONE;
    let mut found: Vec<_> = records
        .iter()
        .zip(cells)
        .rev()
        .map(|((record, terms), cell)| adjoint.retreat(cell, &terms.dynamics, record))
        .collect();
    found.reverse();
    Passed {
        speed_steps: records.iter().any(|(record, _)| record.speed_steps),
        log_likelihood,
        found,
        noise: changed_noise.unwrap(),
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    #[test]
    fn scores_are_derivatives_of_the_likelihood(cells in prop::collection::vec(any_cell(), 12..25), at in 1usize..12, which in 0usize..12) {
        let mut cells = cells;
        cells.insert(0, first());
        // Readings where they do not depend on the state.
        for cell in &mut cells {
            cell.energy_behind_m = 0.0;
        }
        let changed = match which {
            9 => Changed::Load,
            10 => Changed::Speed,
            11 => Changed::Altitude,
            noise => Changed::Of(Noise::ALL[noise]),
        };
        let here = pass(&cells, at, changed, 0.0);
        let found = &here.found[at];
        let score = match changed {
            Changed::Of(noise) => Some(found.of[noise as usize]),
            Changed::Load => (here.noise.load > 0.0).then_some(found.load),
            Changed::Speed => found.speed,
            Changed::Altitude => found.altitude,
        };
        let Some(score) = score else {
            return Ok(());
        };
        // Small beside the variance, and beside what the data know of it.
        let mut noise = here.noise;
        let variance = *place(&mut noise, changed);
        let by = 1e-3 / (1.0 + score.information.abs() + 1.0 / variance.max(1e-3));
        let [below, above] = [-by, by].map(|by| pass(&cells, at, changed, by).log_likelihood);
        let derivative = (above - below) / (2.0 * by);
        let expected = 0.5 * (score.sum * score.sum - score.information);
        let scale = 0.5 * (score.sum * score.sum + score.information) + 1e-6;
        // The score of a step of the speed's sensor is not its derivative.
        prop_assume!(scale < 1e8 && !here.speed_steps);
        prop_assert!((derivative - expected).abs() < 0.02 * scale + 1e-6, "{changed:?}: {derivative} {expected}");
    }
}
