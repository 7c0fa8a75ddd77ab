//! The window behind the vehicle: what it gives, in either precision, with any input.

use crate::cells::{LEVEL, any_cell, first, fix};
use estimator_core::Scalar;
use estimator_core::filter::{CellInput, Reading, State};
use estimator_core::inference::window::{LAG_CELLS, UPDATE_CELLS};
use estimator_core::inference::{Numbers, Window};
use proptest::prelude::*;

/// Grades, %, with their variances.
type Grades = Vec<(f32, f32)>;

/// The live and lagged grades of a drive, and how often the window began anew.
fn grades<S: Scalar>(cells: &[CellInput]) -> (Grades, Grades, u32) {
    let numbers = Numbers::default();
    let mut window = Box::new(Window::<S>::new());
    let (mut live, mut lagged, mut restarts) = (Vec::new(), Vec::new(), 0);
    for cell in cells {
        let found = window.push(&numbers, cell, None, || {
            State::at_start(&numbers, cell, 0.3)
        });
        live.push((found.slope.mean, found.slope.variance));
        restarts += u32::from(found.restarted);
        work(&numbers, &mut window, &mut lagged);
    }
    window.begin_end(&numbers);
    work(&numbers, &mut window, &mut lagged);
    (live, lagged, restarts)
}

/// Does all work that is left, and takes the grades whose lag is over.
fn work<S: Scalar>(numbers: &Numbers, window: &mut Window<S>, lagged: &mut Grades) {
    while window.is_busy() {
        assert!(window.next_finished().is_none());
        window.work(numbers);
    }
    while let Some((cell, _)) = window.next_finished() {
        lagged.push((cell.slope.mean, cell.slope.variance));
    }
}

/// A road of hills of 1 km on which the speed is held.
fn hills(cells: usize) -> Vec<CellInput> {
    let mut altitude_m = 0.0;
    let mut hills = vec![first()];
    for k in 1..cells {
        let slope = 2.0 * (k as f32 * 0.0157).sin();
        altitude_m += 0.025 * slope;
        hills.push(CellInput {
            work: 0.245 * slope + 0.1,
            net_traction_percent: slope + 0.5,
            altitude: if k % 8 == 0 {
                fix(altitude_m)
            } else {
                Reading::NONE
            },
            ..LEVEL
        });
    }
    hills
}

#[test]
fn every_cell_is_given_once_in_order_behind_its_lag() {
    for cells in [1, 39, 40, 41, 239, 240, 241, 1000, 1003] {
        let (live, lagged, _) = grades::<f32>(&hills(cells));
        assert_eq!(live.len(), cells);
        assert_eq!(lagged.len(), cells, "{cells} cells");
    }
    // Nothing before the lag is over.
    let numbers = Numbers::default();
    let mut window = Box::new(Window::<f32>::new());
    let mut lagged = Vec::new();
    for (k, cell) in hills(LAG_CELLS + UPDATE_CELLS).iter().enumerate() {
        window.push(&numbers, cell, None, || {
            State::at_start(&numbers, cell, 0.3)
        });
        work(&numbers, &mut window, &mut lagged);
        let is_due = k + 1 >= LAG_CELLS + UPDATE_CELLS;
        assert_eq!(lagged.is_empty(), !is_due, "cell {k}");
        assert!(lagged.is_empty() || k + 1 - lagged.len() >= LAG_CELLS);
    }
}

#[test]
fn single_precision_gives_what_double_precision_gives() {
    let cells = hills(3_000);
    let (live, lagged, _) = grades::<f32>(&cells);
    let (live_64, lagged_64, _) = grades::<f64>(&cells);
    for (single, double) in live
        .iter()
        .zip(&live_64)
        .chain(lagged.iter().zip(&lagged_64))
    {
        let sigma = double.1.sqrt();
        assert!(
            (single.0 - double.0).abs() < 0.1 * sigma,
            "{single:?} {double:?}"
        );
        assert!(
            (single.1 - double.1).abs() < 0.1 * double.1,
            "{single:?} {double:?}"
        );
    }
}

#[test]
fn lagged_grades_follow_the_road() {
    let (_, lagged, _) = grades::<f32>(&hills(4_000));
    let mut squares = 0.0;
    for (k, (mean, _)) in lagged.iter().enumerate().skip(400) {
        let slope = 2.0 * (k as f32 * 0.0157).sin();
        squares += (mean - slope).powi(2);
    }
    let rmse = (squares / (lagged.len() - 400) as f32).sqrt();
    assert!(rmse < 0.15, "{rmse}");
}

/// Cells of which some are no cells at all.
fn broken_cell() -> impl Strategy<Value = CellInput> {
    let extreme =
        prop::sample::select(vec![0.0, -1.0, 1e-30, 1e30, -1e30, f32::INFINITY, f32::NAN]);
    (any_cell(), 0usize..20, extreme).prop_map(|(mut cell, which, extreme)| {
        match which {
            0 => cell.work = extreme,
            1 => cell.energy.value = extreme,
            2 => cell.altitude.value = extreme,
            3 => cell.net_traction_percent = extreme,
            4 => cell.gravity = extreme,
            5 => cell.duration_s = extreme,
            6 => cell.energy.variance = extreme,
            _ => {}
        }
        cell
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn no_input_makes_a_grade_that_is_not_finite(cells in prop::collection::vec(broken_cell(), 60..400)) {
        let mut cells = cells;
        cells.insert(0, first());
        let (live, _, _) = grades::<f32>(&cells);
        for (mean, variance) in live {
            prop_assert!(mean.is_finite() && variance.is_finite() && variance >= 0.0, "{mean} {variance}");
        }
    }
}
