//! The gross mass that a scale stands for, with values worked out by hand.

use estimator_core::effect::named;
use estimator_core::filter::ModelMass;
use estimator_core::model::{AdoptedEffect, Model};
use estimator_core::{Context, Tuning, Uncertain};
use test_kit::{by_force, sample, truck};

fn scale(value: f32, sigma: f32) -> Uncertain {
    Uncertain { value, sigma }
}

fn near(found: Uncertain, value: f32, sigma: f32) -> bool {
    (found.value / value - 1.0).abs() < 1e-4 && (found.sigma / sigma - 1.0).abs() < 1e-3
}

/// Mass of a model in the cell of a sample, whose mass is 39 t.
fn mass_of(model: impl Into<Model>, is_reported: bool) -> ModelMass {
    let context = Context::new(model, Tuning::default()).unwrap();
    let mut sample = sample(100, 5_000.0, 20.0);
    sample.mass_is_reported = is_reported;
    ModelMass::of(&context, &sample)
}

#[test]
fn the_torque_is_right_within_four_per_cent() {
    let mass = mass_of(truck(), false);
    assert_eq!(mass.told_variance, None);
    // 39,000 / 1.3; 30,000 · √((0.0195/1.3)² + 0.04²).
    let gross = mass.gross_kg(scale(1.3, 0.0195));
    assert!(near(gross, 30_000.0, 1_281.6), "{gross:?}");
    // However exact the scale is, the torque stays.
    let gross = mass.gross_kg(scale(1.0, 0.0));
    assert!(near(gross, 39_000.0, 1_560.0), "{gross:?}");
}

#[test]
fn a_measured_force_has_no_error_of_torque() {
    let gross = mass_of(by_force(), false).gross_kg(scale(0.5, 0.01));
    assert!(near(gross, 78_000.0, 1_560.0), "{gross:?}");
}

#[test]
fn a_reported_mass_is_combined_by_inverse_variance() {
    let mass = mass_of(truck(), true);
    assert_eq!(mass.told_variance, Some(0.05 * 0.05));
    // 38,235 ± 1,967 kg driven, 39,000 ± 1,950 kg reported.
    let gross = mass.gross_kg(scale(1.02, 0.033));
    assert!(near(gross, 38_621.0, 1_384.9), "{gross:?}");
}

#[test]
fn a_reported_mass_that_is_wrong_widens_the_sigma() {
    let mass = mass_of(truck(), true);
    let agreed = mass.gross_kg(scale(1.0, 0.03));
    // 15 t on the road, 39 t reported: the sigma covers what they differ by.
    let gross = mass.gross_kg(scale(2.6, 0.03));
    assert!(gross.sigma > 3.0 * agreed.sigma, "{gross:?} {agreed:?}");
    assert!(
        (gross.value - 15_000.0).abs() < 2.0 * gross.sigma,
        "{gross:?}"
    );
}

#[test]
fn an_adopted_mass_with_a_sigma_counts_too() {
    let model = |amount_sigma| {
        let mut model = Model::from(truck());
        let effect = named("mass").unwrap();
        model
            .effects
            .adopt(AdoptedEffect::new(effect, 0.25, amount_sigma))
            .unwrap();
        model
    };
    // A part of 1.25 that is right within 0.025 is right within 2 %.
    let known = mass_of(model(0.025), false).told_variance.unwrap();
    assert!((known - 0.000_4).abs() < 1e-8);
    let both = mass_of(model(0.025), true).told_variance.unwrap();
    assert!((both - 0.002_9).abs() < 1e-8);
    // Without a sigma nothing is told.
    assert_eq!(mass_of(model(0.0), false).told_variance, None);
}

#[test]
fn scales_that_no_vehicle_has_give_a_mass_and_a_sigma_that_says_so() {
    let mass = mass_of(truck(), false);
    for (value, limit) in [(0.0, 0.2), (-3.0, 0.2), (1e-9, 0.2), (7.0, 5.0), (1e9, 5.0)] {
        let gross = mass.gross_kg(scale(value, 0.01));
        assert!(
            (gross.value * limit / 39_000.0 - 1.0).abs() < 1e-5,
            "{gross:?}"
        );
        let beyond = (value - limit).abs() / limit;
        assert!(gross.sigma >= beyond * gross.value, "{value}: {gross:?}");
        assert!(gross.sigma.is_finite());
    }
}
