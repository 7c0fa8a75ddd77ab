//! Doubt of the vehicle model: a resistance that comes at once, before the climb test is certain.

use super::altitude_gate::tuned_drive;
use estimator_core::filter::ModelMass;
use estimator_core::smoother::fixed_lag::{BLOCK_CELLS, LAG_CELLS};
use estimator_core::{Tuning, Uncertain};
use test_kit::{FilteredStep, cells, truck};

/// First cell with the resistance.
pub(super) const FROM: u32 = 2_000;

/// Drives on a level road, from [`FROM`] on against a resistance that the model lacks, in % of the
/// weight.
pub(super) fn drive(resistance_percent: f32, tuning: Tuning) -> Vec<FilteredStep<f64>> {
    let resistance_n = 0.01 * resistance_percent * truck().mass_kg * 9.806_65;
    let (steps, _) = tuned_drive(
        tuning,
        3_600,
        |_, altitude_m| Some(altitude_m),
        |k, sample| {
            if k >= FROM {
                sample.forces.traction_n += resistance_n;
            }
        },
    );
    steps
}

fn undoubting() -> Tuning {
    let mut tuning = Tuning::default();
    tuning.gates.doubt_mean = 1e4;
    tuning
}

fn live(step: &FilteredStep<f64>) -> Uncertain {
    step.state.estimate(&ModelMass::default()).grade_percent
}

/// Returns the mean squared error over its variance, on a level road.
fn nees(grades: impl Iterator<Item = Uncertain>) -> f32 {
    let squares: Vec<f32> = grades.map(|g| (g.value / g.sigma).powi(2)).collect();
    squares.iter().sum::<f32>() / squares.len() as f32
}

#[test]
fn a_resistance_that_comes_at_once_widens_the_grades_and_moves_no_state() {
    for (resistance_percent, at_most) in [(0.3, 0.6), (0.5, 0.3), (-0.5, 0.5)] {
        let doubting = drive(resistance_percent, Tuning::default());
        let certain = drive(resistance_percent, undoubting());
        assert!(doubting.iter().any(|step| step.state.doubt_variance > 0.0));
        for (a, b) in doubting.iter().zip(&certain) {
            assert_eq!(a.state.mean, b.state.mean);
            assert_eq!(a.state.covariance, b.state.covariance);
            assert!(live(a).sigma >= live(b).sigma);
        }
        // The road is level, so a grade is its error. 1.5 km from the onset on.
        let onset = FROM as usize..FROM as usize + 600;
        let lagged = |steps| {
            let cells = cells(steps);
            nees(
                cells[onset.clone()]
                    .iter()
                    .map(|cell| cell.lagged_grade_percent),
            )
        };
        let (told, untold) = (lagged(&doubting), lagged(&certain));
        assert!(untold > 4.0, "{resistance_percent} %: {untold}");
        assert!(
            told < at_most * untold,
            "{resistance_percent} %: {told} {untold}"
        );
    }
}

#[test]
fn a_lagged_grade_knows_the_doubts_of_its_lag() {
    let doubting = drive(0.5, Tuning::default());
    let plain = cells(&drive(0.5, undoubting()));
    let mut widened = 0;
    for (k, (told, plain)) in cells(&doubting).iter().zip(&plain).enumerate() {
        let block = k / BLOCK_CELLS * BLOCK_CELLS;
        let seen = doubting.len().min(block + BLOCK_CELLS + LAG_CELLS);
        let doubts = doubting[block..seen].iter();
        let doubt = doubts
            .map(|step| step.state.doubt_variance)
            .fold(0.0, f32::max);
        widened += usize::from(doubt > 0.0);
        for (told, plain, doubt) in [
            (told.lagged_grade_percent, plain.lagged_grade_percent, doubt),
            (
                told.live_grade_percent,
                plain.live_grade_percent,
                doubting[k].state.doubt_variance,
            ),
        ] {
            assert_eq!(told.value, plain.value);
            let sigma = (plain.sigma.powi(2) + doubt).sqrt();
            assert!(
                (told.sigma / sigma - 1.0).abs() < 1e-5,
                "{k}: {told:?} {sigma}"
            );
        }
    }
    assert!((300..600).contains(&widened), "{widened}");
}

#[test]
fn without_a_missing_resistance_nothing_is_in_doubt() {
    let steps = drive(0.0, Tuning::default());
    assert!(steps.iter().all(|step| step.state.doubt_variance == 0.0));
}
