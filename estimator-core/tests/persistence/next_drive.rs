//! What one drive leaves for the next: when, what, and where the next drive begins.

use estimator_core::{Estimator, Tuning};
use test_kit::by_force;
use test_kit::hilly_drive::{Bus, KEPT, USUAL, drive, fresh};

#[test]
fn what_a_drive_has_learned_is_in_it() {
    let estimator = drive::<f32>(fresh(), 12_000, USUAL);
    let slow = *estimator.kept().unwrap().slow_states();
    // 10 % heavier than believed: less traction per kilogram than the model has.
    assert!(
        (slow.scale_error - (1.0 / 1.1 - 1.0)).abs() < 0.03,
        "{slow:?}"
    );
    let scale = estimator.live().unwrap().estimate.scale;
    assert_eq!(1.0 + slow.scale_error, scale.value);
    assert!((slow.scale_variance.sqrt() - scale.sigma).abs() < 1e-6);
    assert!(slow.covariance.powi(2) < slow.bias_variance * slow.scale_variance);
    // Readings without noise: the sensors turned out better than believed.
    let (kept, learned) = (KEPT.noise(&Tuning::default()), estimator.noise());
    assert!(learned.speed < 0.5);
    for (kept, learned) in [
        (kept.speed, learned.speed),
        (kept.altitude, learned.altitude),
        (kept.gnss_error, learned.gnss_error),
    ] {
        assert!((kept / learned - 1.0).abs() < 1e-5, "{kept} {learned}");
    }
    // In units: a release that believes twice the sigma sees a quarter of the variance.
    let coarser = Tuning {
        speed_sigma_mps: 2.0 * Tuning::default().speed_sigma_mps,
        ..Tuning::default()
    };
    assert!((KEPT.noise(&coarser).speed / kept.speed - 0.25).abs() < 1e-5);
}

#[test]
fn precisions_leave_the_same() {
    let double = drive::<f64>(fresh(), 12_000, USUAL).kept().unwrap();
    let (single, double) = (KEPT.slow_states(), double.slow_states());
    assert!((single.scale_error - double.scale_error).abs() < 0.01);
    assert!((single.bias_percent - double.bias_percent).abs() < 0.02);
}

#[test]
fn a_short_drive_or_one_without_gnss_leaves_nothing() {
    let no_gnss = Bus {
        gnss: false,
        ..USUAL
    };
    assert_eq!(fresh::<f32>().kept(), None);
    assert_eq!(drive::<f32>(fresh(), 4_900, USUAL).kept(), None);
    assert_eq!(drive::<f32>(fresh(), 12_000, no_gnss).kept(), None);
    assert!(drive::<f32>(fresh(), 5_100, USUAL).kept().is_some());
}

/// Bias and scale at the first cells of a drive without GNSS, which would tell more of them.
fn first_cells(estimator: Estimator<f32>, mass_kg: Option<f32>) -> estimator_core::Estimate {
    let gnss = false;
    let estimator = drive(estimator, 10, Bus { gnss, mass_kg });
    estimator.live().unwrap().estimate
}

fn restored() -> Estimator<f32> {
    Estimator::with_kept(by_force(), Tuning::default(), &KEPT).unwrap()
}

#[test]
fn the_next_drive_begins_with_it_and_wider() {
    let slow = KEPT.slow_states();
    let (known, unknown) = (first_cells(restored(), None), first_cells(fresh(), None));
    // Nearly all of the scale, less sure than it was: the load may have changed.
    assert!((known.scale.value - 1.0 - 0.9 * slow.scale_error).abs() < 0.001);
    assert!(known.scale.sigma > 2.0 * slow.scale_variance.sqrt());
    assert!((0.1..0.15).contains(&known.scale.sigma), "{known:?}");
    // A part of the bias; tyres are cold again.
    assert!(known.bias_percent.value.abs() < 0.5 * slow.bias_percent.abs() + 0.001);
    let sigmas = known.bias_percent.sigma / unknown.bias_percent.sigma;
    assert!((0.9..=1.0).contains(&sigmas), "{sigmas}");
    // And with the sensors it had.
    assert!((restored().noise().speed / KEPT.noise(&Tuning::default()).speed - 1.0).abs() < 1e-6);
}

#[test]
fn another_mass_told_leaves_the_scale_as_at_a_first_drive() {
    let (lighter, fresh) = (
        first_cells(restored(), Some(20_000.0)),
        first_cells(fresh(), Some(20_000.0)),
    );
    assert_eq!(lighter.scale, fresh.scale);
    let weighed_again = first_cells(restored(), Some(39_500.0));
    assert_eq!(weighed_again.scale, first_cells(restored(), None).scale);

    // Learned with a mass from the bus, and the same one told again.
    let told = Bus {
        mass_kg: Some(43_000.0),
        ..USUAL
    };
    let kept = drive::<f32>(self::fresh(), 12_000, told).kept().unwrap();
    assert_eq!(kept.slow_states().mass_kg, 43_000.0);
    let again = Estimator::with_kept(by_force(), Tuning::default(), &kept).unwrap();
    let scale = first_cells(again, Some(43_000.0)).scale.value - 1.0;
    assert!((scale - 0.9 * kept.slow_states().scale_error).abs() < 0.001);
}

#[test]
fn a_second_look_begins_as_the_first() {
    let estimator = drive(restored(), 3_000, USUAL);
    let sample = estimator.sample().unwrap();
    let start = |mut filter: estimator_core::filter::Filter<f64>| {
        let mut counters = estimator_core::Counters::default();
        filter.step(
            estimator.vehicle(),
            estimator.tuning(),
            sample,
            &mut counters,
        );
        filter.state().unwrap().estimate().scale
    };
    let scale = start(estimator.filter_anew());
    assert!((scale.value - 1.0 - 0.9 * KEPT.slow_states().scale_error).abs() < 0.001);
    assert_eq!(estimator.filter_anew::<f64>().noise(), estimator.noise());
}
