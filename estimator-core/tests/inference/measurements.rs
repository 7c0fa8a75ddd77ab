//! The contract of a measurement.

use crate::cells::{any_cell, first};
use estimator_core::filter::{
    CellInput, CellNoise, Measurand, Measurement, Reading, Record, State, StateVector,
};
use estimator_core::inference::{CellModel, CellVariances, Levels, Numbers, SegmentVariances};
use proptest::prelude::*;

/// The step over the last of some cells: its measurements, the variances it used, and where it led.
struct Step {
    measurements: [Option<Measurement<f64>>; 3],
    noise: CellNoise<f64>,
    mean: StateVector<f64>,
}

/// Drives over cells. The gate is that of the last one.
fn drive(cells: &[CellInput], own: &CellVariances, gate: Option<f64>) -> Step {
    let numbers = Numbers::default();
    let model = CellModel::new(&numbers);
    let segment = SegmentVariances::start(&numbers, 1.0);
    let mut state = State::<f64>::at_start(&numbers, &cells[0], 0.3);
    let mut found = None;
    for (index, cell) in cells.iter().enumerate() {
        let terms = model.terms::<f64>(cell, own, &segment, index == 0, &Levels::ONE);
        let gate = gate.filter(|_| index + 1 == cells.len());
        let mut record = Record::EMPTY;
        if cell.marks.gap {
            state.start(&numbers, cell, &terms.noise, 1.0, gate, &mut record);
        } else {
            state.step(cell, &terms.dynamics, &terms.noise, gate, &mut record);
        }
        found = Some(Step {
            measurements: record.measurements(cell, &terms.noise),
            noise: terms.noise,
            mean: state.mean,
        });
    }
    found.unwrap()
}

/// A drive whose last cell may have a slope, and may be behind a gap.
fn any_drive() -> impl Strategy<Value = Vec<CellInput>> {
    let cells = prop::collection::vec(any_cell(), 1..10);
    let slope = prop::option::of(-1.0_f32..1.0);
    (cells, slope, any::<bool>(), any::<bool>()).prop_map(|(mut cells, slope, is_read, gap)| {
        let last = cells.last_mut().unwrap();
        last.slope = slope.map_or(Reading::NONE, |value| Reading {
            value,
            variance: 0.5,
        });
        last.marks.slope_is_read = is_read;
        last.marks.gap = gap;
        [vec![first()], cells].concat()
    })
}

const MEASURANDS: [Measurand; 3] = [Measurand::Speed, Measurand::Altitude, Measurand::Slope];

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn each_reading_has_its_measurement(
        cells in any_drive(),
        weight in 0.01_f32..10.0,
    ) {
        let own = CellVariances { altitude_weight: weight, slope_weight: weight, ..CellVariances::START };
        let step = drive(&cells, &own, None);
        let cell = cells.last().unwrap();
        let readings = [cell.energy, cell.altitude, cell.slope];
        let variances = [step.noise.speed, step.noise.altitude, step.noise.slope];
        let weights = [1.0, weight, weight];
        for (index, measurement) in step.measurements.iter().enumerate() {
            let reading: Reading = readings[index];
            prop_assert_eq!(measurement.is_some(), reading.is_some());
            let Some(found) = measurement else { continue };
            prop_assert_eq!(found.measurand, MEASURANDS[index]);
            prop_assert_eq!(found.observation, f64::from(reading.value));
            prop_assert_eq!(found.variance, variances[index]);
            prop_assert!(found.innovation_variance > found.variance);
            let ratio = found.innovation * found.innovation / found.innovation_variance;
            prop_assert!((found.test_ratio - ratio).abs() <= 1e-12 * ratio);
            let weight = f64::from(weights[index]);
            prop_assert!((found.weight / weight - 1.0).abs() < 1e-5);
            let begins = cell.marks.gap && found.measurand != Measurand::Slope;
            prop_assert!(found.used != begins || found.measurand == Measurand::Speed);
        }
    }

    #[test]
    fn what_the_gate_leaves_out_changes_nothing_and_is_told(
        cells in any_drive(),
    ) {
        let own = CellVariances::START;
        let mut cells = cells;
        let left_out = drive(&cells, &own, Some(0.0));
        let cell = cells.last_mut().unwrap();
        let begins_with_altitude = cell.marks.gap;
        let readings = [cell.altitude, cell.slope];
        (cell.altitude, cell.slope) = (Reading::NONE, Reading::NONE);
        let without = drive(&cells, &own, None);
        prop_assert!(begins_with_altitude || left_out.mean == without.mean);
        for (measurement, reading) in left_out.measurements[1..].iter().zip(readings) {
            prop_assert_eq!(measurement.is_some(), reading.is_some());
            if let Some(found) = measurement {
                prop_assert!(!found.used || found.innovation == 0.0);
                prop_assert!(found.innovation.is_finite());
            }
        }
    }
}

#[test]
fn a_speed_that_no_force_explains_does_not_count_as_used() {
    let own = CellVariances::START;
    let mut next = first();
    next.marks.gap = false;
    let used = |cells: &[CellInput]| drive(cells, &own, None).measurements[0].unwrap().used;
    assert!(used(&[first(), next]));
    next.energy.value *= 2.0;
    assert!(!used(&[first(), next]));
}
