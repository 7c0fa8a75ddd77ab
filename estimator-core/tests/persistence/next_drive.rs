//! What one drive leaves for the next: its content, its conditions, and the start of the next drive.

use estimator_core::{Estimate, Estimator, Tuning};
use test_kit::by_force;
use test_kit::hilly_drive::{BusSignals, KEPT, USUAL, drive, fresh};

#[test]
fn the_state_contains_what_a_drive_has_learned() {
    let estimator = drive::<f32>(fresh(), 12_000, USUAL);
    let slow = *estimator.persistent_state().unwrap().slow_states();
    // 10 % heavier than the model: less traction per kilogram than the model has.
    assert!(
        (slow.scale.mean - (1.0 / 1.1 - 1.0)).abs() < 0.03,
        "{slow:?}"
    );
    let scale = estimator.live().unwrap().estimate.scale;
    assert_eq!(1.0 + slow.scale.mean, scale.value);
    assert!((slow.scale.variance.sqrt() - scale.sigma).abs() < 1e-6);
    assert!(slow.covariance.powi(2) < slow.bias.variance * slow.scale.variance);
    // Readings without noise: the learned noise is lower than the assumed one.
    assert!(KEPT.levels().altitude < 0.5, "{:?}", KEPT.levels());
    assert!(!KEPT.hides_brakes());
}

#[test]
fn all_precisions_leave_the_same_state() {
    let double = drive::<f64>(fresh(), 12_000, USUAL)
        .persistent_state()
        .unwrap();
    let (single, double) = (KEPT.slow_states(), double.slow_states());
    assert!((single.scale.mean - double.scale.mean).abs() < 0.01);
    assert!((single.bias.mean - double.bias.mean).abs() < 0.02);
}

#[test]
fn a_short_drive_or_one_without_gnss_leaves_nothing() {
    let no_gnss = BusSignals {
        gnss: false,
        ..USUAL
    };
    assert_eq!(fresh::<f32>().persistent_state(), None);
    assert_eq!(drive::<f32>(fresh(), 4_900, USUAL).persistent_state(), None);
    assert_eq!(
        drive::<f32>(fresh(), 12_000, no_gnss).persistent_state(),
        None
    );
    assert!(
        drive::<f32>(fresh(), 5_100, USUAL)
            .persistent_state()
            .is_some()
    );
}

/// Returns bias and scale at the first cells of a drive without GNSS, which would correct them.
fn first_cells(estimator: Estimator<f32>, mass_kg: Option<f32>) -> Estimate {
    let gnss = false;
    let estimator = drive(estimator, 10, BusSignals { gnss, mass_kg });
    estimator.live().unwrap().estimate
}

fn restored() -> Estimator<f32> {
    Estimator::restore(by_force(), Tuning::default(), &KEPT).unwrap()
}

#[test]
fn the_next_drive_begins_with_it_and_wider() {
    let slow = KEPT.slow_states();
    let (known, unknown) = (first_cells(restored(), None), first_cells(fresh(), None));
    // Nearly all of the scale. Its sigma is that of any load until this drive agrees.
    assert!((known.scale.value - 1.0 - 0.9 * slow.scale.mean).abs() < 0.001);
    assert!(known.scale.sigma > 2.0 * slow.scale.variance.sqrt());
    assert!(known.scale.sigma > 0.2, "{known:?}");
    // A part of the bias; tyres are cold again.
    assert!(known.bias_percent.value.abs() < 0.5 * slow.bias.mean.abs() + 0.001);
    let sigmas = known.bias_percent.sigma / unknown.bias_percent.sigma;
    assert!((0.9..=1.0).contains(&sigmas), "{sigmas}");
}

#[test]
fn another_reported_mass_leaves_the_scale_as_at_a_first_drive() {
    let (lighter, fresh) = (
        first_cells(restored(), Some(20_000.0)),
        first_cells(fresh(), Some(20_000.0)),
    );
    assert_eq!(lighter.scale, fresh.scale);
    let weighed_again = first_cells(restored(), Some(39_500.0));
    let unweighed = first_cells(restored(), None);
    let difference = weighed_again.scale.value - unweighed.scale.value;
    assert!(difference.abs() < 1e-3, "{difference}");
    // Reports are wrong now and then: the load stays open.
    assert!((weighed_again.scale.sigma / unweighed.scale.sigma - 1.0).abs() < 0.05);

    // Learned with a mass from the bus, which reports the same mass again.
    let reported = BusSignals {
        mass_kg: Some(43_000.0),
        ..USUAL
    };
    let state = drive::<f32>(self::fresh(), 12_000, reported)
        .persistent_state()
        .unwrap();
    assert_eq!(state.slow_states().mass_kg, 43_000.0);
    let again = Estimator::restore(by_force(), Tuning::default(), &state).unwrap();
    let scale = first_cells(again, Some(43_000.0)).scale.value - 1.0;
    assert!((scale - 0.9 * state.slow_states().scale.mean).abs() < 0.001);
}

#[test]
fn a_reported_mass_is_part_of_the_live_mass() {
    // 20,000 kg within a half by the scale, within 5 % by the report.
    let reported = first_cells(fresh(), Some(20_000.0)).mass_kg;
    assert!((reported.value - 20_000.0).abs() < 20.0, "{reported:?}");
    assert!((reported.sigma - 995.0).abs() < 10.0, "{reported:?}");
    // A file is for one load of many: the sigma is that of any load.
    let parameter = first_cells(fresh(), None).mass_kg;
    assert!((parameter.value - 39_000.0).abs() < 40.0, "{parameter:?}");
    assert!(parameter.sigma > 13_000.0, "{parameter:?}");
}
