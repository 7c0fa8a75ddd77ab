//! An adopted effect that a vehicle has leaves its estimates as they are without the effect. The
//! uncertainty of its amount is part of theirs.

use estimator_core::effect::{self, CATALOGUE, Effect};
use estimator_core::estimator::CellEstimator;
use estimator_core::vehicle::GRAVITY;
use estimator_core::{
    AdoptedEffect, Context, Estimate, Estimator, Model, PersistentStateError, Tuning,
    VehicleParameters,
};
use test_kit::effect_drive::{
    AMBIENT_CELSIUS, DEG_PER_KM, PLAIN, PlantedDifference, START_LATITUDE_DEG, VehicleMoment, drive,
};
use test_kit::hilly_drive::KEPT;
use test_kit::readings_drive::ReadingsDrive;
use test_kit::{by_force, truck};

const SECONDS: f32 = 400.0;
const WEIGHT_N: f32 = 39_000.0 * GRAVITY;

/// Returns the model of a vehicle with these effects.
fn with(vehicle: VehicleParameters, adopted: &[AdoptedEffect]) -> Model {
    let mut model = Model::from(vehicle);
    for adopted in adopted {
        model.effects.adopt(*adopted).unwrap();
    }
    model
}

fn adopted(name: &str, amount: f32, parameters: &[(&str, f32)]) -> AdoptedEffect {
    let mut adopted = AdoptedEffect::new(effect::named(name).unwrap(), amount, 0.0);
    for &(key, value) in parameters {
        assert!(adopted.set(key, value));
    }
    adopted
}

/// Returns the RMS difference of two drives' live grades from 50 m on, %.
fn difference(one: &[Estimate], other: &[Estimate]) -> f32 {
    let squares = one.iter().zip(other).skip(20).map(|(one, other)| {
        let difference = one.grade_percent.value - other.grade_percent.value;
        difference * difference
    });
    let count = one.len().min(other.len()) - 20;
    (squares.sum::<f32>() / count as f32).sqrt()
}

/// Traction as the bus reports it, N.
type ReportedForce = fn(&VehicleMoment) -> f32;

/// Returns effects of a vehicle, each with the traction that the bus then reports.
fn resisting() -> Vec<(AdoptedEffect, ReportedForce)> {
    let middle = START_LATITUDE_DEG + 4.0 * DEG_PER_KM;
    let stretch = [("latitude_deg", middle), ("length_m", 4_000.0)];
    let wind = [("from_deg", 60.0)];
    vec![
        (adopted("rolling_resistance", 0.002, &[]), |m| {
            m.force_n + 0.002 * WEIGHT_N
        }),
        (adopted("tyre_warmup", 0.5, &[("time_s", 300.0)]), |m| {
            m.force_n + 0.5 * 0.0065 * WEIGHT_N * (-m.seconds / 300.0).exp()
        }),
        (adopted("air_drag", 3.0, &[]), |m| {
            m.force_n + 0.5 * 1.2 * 3.0 * m.speed_mps.powi(2)
        }),
        (adopted("headwind", 8.0, &wind), |m| {
            let air_mps = m.speed_mps + 8.0 * (m.course_deg - 60.0).to_radians().cos();
            m.force_n + 0.5 * 1.2 * 6.0 * (air_mps.powi(2) - m.speed_mps.powi(2))
        }),
        (adopted("cornering", 0.3, &[]), |m| {
            let sideways = m.speed_mps * m.yaw_rate_radps / GRAVITY;
            m.force_n + 0.3 * WEIGHT_N * sideways.powi(2)
        }),
        (adopted("driveline_loss", 0.1, &[]), |m| {
            m.force_n / if m.force_n > 0.0 { 0.9 } else { 1.1 }
        }),
        (
            adopted("auxiliary_load", 30_000.0, &[("with_fan", 1.0)]),
            |m| m.force_n + 30_000.0 * 0.01 * m.fan_percent / m.speed_mps,
        ),
        (adopted("brake_drag", 800.0, &[]), |m| m.force_n + 800.0),
        (adopted("road_surface", 0.003, &stretch), |m| {
            let inside = (m.driven_m - 4_000.0).abs() < 2_000.0;
            m.force_n + if inside { 0.003 * WEIGHT_N } else { 0.0 }
        }),
        (adopted("tyre_temperature", 0.02, &[]), |m| {
            m.force_n + 0.02 * 0.0065 * WEIGHT_N * (25.0 - AMBIENT_CELSIUS)
        }),
        (adopted("torque_scale", -0.1, &[]), |m| m.force_n / 0.9),
    ]
}

#[test]
fn a_known_effect_does_not_change_the_estimates() {
    let vehicle = by_force();
    let base = Model::from(vehicle.clone());
    let plain = drive(&base, &vehicle, PLAIN, SECONDS);
    for (adopted, reported_n) in resisting() {
        let planted = PlantedDifference {
            reported_n,
            ..PLAIN
        };
        let knows = with(vehicle.clone(), &[adopted]);
        let known = difference(&plain, &drive(&knows, &vehicle, planted, SECONDS));
        let missing = difference(&plain, &drive(&base, &vehicle, planted, SECONDS));
        eprintln!(
            "{}: known {known} %, missing {missing} %",
            adopted.effect.name
        );
        assert!(
            missing > 0.02,
            "{}: missing {missing} %",
            adopted.effect.name
        );
        assert!(
            known < 0.1 * missing,
            "{}: {known} of {missing} %",
            adopted.effect.name
        );
    }
}

#[test]
fn a_known_scale_does_not_change_the_estimates() {
    let truth = truck();
    let plain = drive(&truth.clone().into(), &truth, PLAIN, SECONDS);
    // A mass that is too small; wheels that are too small, with a reported speed that is as small.
    let light = VehicleParameters {
        mass_kg: truth.mass_kg / 1.2,
        ..truth.clone()
    };
    let small = VehicleParameters {
        wheel_radius_m: truth.wheel_radius_m / 1.05,
        ..truth.clone()
    };
    let slow = PlantedDifference {
        true_over_reported: 1.05,
        ..PLAIN
    };
    for (assumed, planted, adopted) in [
        (light, PLAIN, adopted("mass", 0.2, &[])),
        (small, slow, adopted("wheel_radius", 0.05, &[])),
    ] {
        let name = adopted.effect.name;
        let missing = drive(&assumed.clone().into(), &truth, planted, SECONDS);
        let known = drive(&with(assumed, &[adopted]), &truth, planted, SECONDS);
        assert_eq!(known.len(), plain.len(), "{name}");
        let (known, missing) = (difference(&plain, &known), difference(&plain, &missing));
        eprintln!("{name}: known {known} %, missing {missing} %");
        assert!(missing > 0.03, "{name}: missing {missing} %");
        assert!(known < 0.02 * missing, "{name}: {known} of {missing} %");
    }
}

#[test]
fn masses_reported_on_the_bus_are_scaled_too() {
    use estimator_core::Signal;
    let heavier = with(by_force(), &[adopted("mass", 0.1, &[])]);
    let mut drive = ReadingsDrive::of(heavier);
    let readings = [
        (Signal::TractionForce, 4_000.0),
        (Signal::Mass, 30_000.0),
        (Signal::WheelSpeed, 20.0),
    ];
    for sample in drive.on(5.0, &readings) {
        assert!((sample.forces.mass_kg - 33_000.0).abs() < 0.1);
    }
}

/// Returns the mean sigmas of the live bias, of the scale and of the grade after some minutes.
fn sigmas(adopted: AdoptedEffect) -> [f32; 3] {
    let vehicle = by_force();
    let planted = PlantedDifference {
        reported_n: |m| m.force_n,
        ..PLAIN
    };
    let estimates = drive(&with(vehicle.clone(), &[adopted]), &vehicle, planted, 120.0);
    let mean = |sigma: fn(&Estimate) -> f32| {
        estimates.iter().map(sigma).sum::<f32>() / estimates.len() as f32
    };
    [
        mean(|e| e.bias_percent.sigma),
        mean(|e| e.scale.sigma),
        mean(|e| e.grade_percent.sigma),
    ]
}

/// Returns the same sigmas after 100 m of a steady climb, where the bus reports the mass.
fn sigmas_of_a_reported_mass(adopted: AdoptedEffect) -> [f32; 3] {
    use estimator_core::Signal;
    let model = with(by_force(), &[adopted]);
    let readings = [
        (Signal::Mass, 39_000.0),
        (Signal::TractionForce, 12_000.0),
        (Signal::WheelSpeed, 20.0),
    ];
    let mut context = Context::new(model.clone(), Tuning::default()).unwrap();
    let mut estimator = Box::new(CellEstimator::<f32>::new());
    let samples = ReadingsDrive::of(model).on(5.0, &readings);
    assert!(samples.iter().all(|sample| sample.mass_is_reported));
    for sample in &samples {
        estimator.push_and_work(&mut context, sample);
    }
    let estimate = estimator.live(&context, &samples[0]).unwrap().estimate;
    [
        estimate.bias_percent.sigma,
        estimate.scale.sigma,
        estimate.grade_percent.sigma,
    ]
}

fn acts_on_the_scale(effect: &Effect) -> bool {
    matches!(effect.name, "mass" | "torque_scale")
}

#[test]
fn uncertainty_of_an_amount_is_uncertainty_of_the_grade() {
    for effect in CATALOGUE {
        let on_scale = acts_on_the_scale(effect);
        let of_sigma = |sigmas_of_typical: f32| {
            let adopted = AdoptedEffect::new(effect, 0.0, sigmas_of_typical * effect.typical);
            if on_scale {
                sigmas_of_a_reported_mass(adopted)
            } else {
                sigmas(adopted)
            }
        };
        let [certain, uncertain, more] = [0.0, 1.0, 3.0].map(of_sigma);
        let which = usize::from(on_scale);
        eprintln!("{}: {certain:?} {uncertain:?} {more:?}", effect.name);
        assert!(
            certain[which] < uncertain[which] && uncertain[which] < more[which],
            "{}",
            effect.name
        );
        assert!(
            certain[2] < uncertain[2] && uncertain[2] < more[2],
            "{}",
            effect.name
        );
    }
}

/// The uncertainty of a fan's power counts while the fan is on, and not before.
#[test]
fn uncertainty_comes_with_what_it_depends_on() {
    let vehicle = by_force();
    let fan = effect::named("auxiliary_load").unwrap();
    let bias_sigma = |amount_sigma: f32| -> Vec<f32> {
        let mut adopted = AdoptedEffect::new(fan, 20_000.0, amount_sigma);
        assert!(adopted.set("with_fan", 1.0));
        let knows = with(vehicle.clone(), &[adopted]);
        drive(&knows, &vehicle, PLAIN, 110.0)
            .iter()
            .map(|estimate| estimate.bias_percent.sigma)
            .collect()
    };
    let (certain, uncertain) = (bias_sigma(0.0), bias_sigma(15_000.0));
    // The fan is on from 60 s, 1.2 km, on. The uncertainty follows within 100 m.
    let off = 400;
    let on = 600;
    assert_eq!(certain[..off], uncertain[..off]);
    // Of 15 kW at 90 % and 22 m/s, in % of the weight.
    let expected = 100.0 * 15_000.0 * 0.9 / 21.9 / WEIGHT_N;
    let added = (uncertain[on].powi(2) - certain[on].powi(2)).sqrt();
    assert!(
        (0.7 * expected..1.1 * expected).contains(&added),
        "{added} of {expected}"
    );
}

#[test]
fn a_state_learned_without_an_effect_is_refused_with_one() {
    let refused = |adopted: AdoptedEffect| {
        let model = with(by_force(), &[adopted]);
        Estimator::<f32>::restore(model, Tuning::default(), &KEPT).map(drop)
    };
    for effect in CATALOGUE {
        assert_eq!(
            refused(AdoptedEffect::new(effect, 0.0, 0.0)),
            Err(PersistentStateError::Vehicle)
        );
    }

    // The fingerprint covers every number of an effect.
    let wind = adopted("headwind", 3.0, &[]);
    let estimator = Estimator::<f32>::new(with(by_force(), &[wind]), Tuning::default()).unwrap();
    let state = test_kit::hilly_drive::drive(estimator, 12_000, test_kit::hilly_drive::USUAL)
        .persistent_state()
        .unwrap();
    let check = |adopted: AdoptedEffect| state.check_model(&with(by_force(), &[adopted]));
    assert_eq!(check(wind), Ok(()));
    for other in [
        adopted("headwind", 3.1, &[]),
        adopted("brake_drag", 3.0, &[]),
        adopted("headwind", 3.0, &[("from_deg", 0.0)]),
        AdoptedEffect {
            amount_sigma: 0.1,
            ..wind
        },
    ] {
        assert_eq!(check(other), Err(PersistentStateError::Vehicle));
    }
}
