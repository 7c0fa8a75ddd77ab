//! A vehicle that has an effect and knows of it drives like one that has none; what it does not
//! know for sure, it says.

use estimator_core::effect::CATALOGUE;
use estimator_core::vehicle::GRAVITY;
use estimator_core::{
    Adopted, Effect, Effects, Estimate, Estimator, KeptError, Tuning, VehicleParameters,
};
use test_kit::by_force;
use test_kit::effect_drive::{DEG_PER_KM, Moment, PLAIN, Planted, START_LATITUDE_DEG, drive};
use test_kit::hilly_drive::KEPT;
use test_kit::truck;

const SECONDS: f32 = 400.0;
const WEIGHT_N: f32 = 39_000.0 * GRAVITY;

/// With these effects.
fn with(vehicle: VehicleParameters, adopted: &[Adopted]) -> VehicleParameters {
    let mut effects = Effects::default();
    for adopted in adopted {
        effects.adopt(*adopted).unwrap();
    }
    VehicleParameters { effects, ..vehicle }
}

fn adopted(name: &str, amount: f32, details: &[(&str, f32)]) -> Adopted {
    let mut adopted = Adopted::new(Effect::named(name).unwrap(), amount, 0.0);
    for &(key, value) in details {
        assert!(adopted.set(key, value));
    }
    adopted
}

/// Root of the mean squared difference of two drives' live grades, %, from 50 m on.
fn difference(one: &[Estimate], other: &[Estimate]) -> f32 {
    let squares = one.iter().zip(other).skip(20).map(|(one, other)| {
        let difference = one.grade_percent.value - other.grade_percent.value;
        difference * difference
    });
    let count = one.len().min(other.len()) - 20;
    (squares.sum::<f32>() / count as f32).sqrt()
}

/// Traction as the bus tells it, N.
type Told = fn(&Moment) -> f32;

/// What a vehicle has, and how the bus then tells its traction.
fn resisting() -> Vec<(Adopted, Told)> {
    let half_way = START_LATITUDE_DEG + 4.0 * DEG_PER_KM;
    let stretch = [("latitude_deg", half_way), ("length_m", 4_000.0)];
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
            let inside = (m.way_m - 4_000.0).abs() < 2_000.0;
            m.force_n + if inside { 0.003 * WEIGHT_N } else { 0.0 }
        }),
        (adopted("torque_scale", -0.1, &[]), |m| m.force_n / 0.9),
    ]
}

#[test]
fn an_effect_that_is_known_is_as_none() {
    let vehicle = by_force();
    let plain = drive(&vehicle, &vehicle, PLAIN, SECONDS);
    for (adopted, told_n) in resisting() {
        let planted = Planted { told_n, ..PLAIN };
        let knows = with(vehicle.clone(), &[adopted]);
        let known = difference(&plain, &drive(&knows, &vehicle, planted, SECONDS));
        let missing = difference(&plain, &drive(&vehicle, &vehicle, planted, SECONDS));
        eprintln!(
            "{}: known {known} %, missing {missing} %",
            adopted.effect.name
        );
        assert!(
            missing > 0.03,
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
fn a_scale_that_is_known_is_as_none() {
    let truth = truck();
    let plain = drive(&truth, &truth, PLAIN, SECONDS);
    // Believed to be too light, or to have wheels too small while the bus's speed is as small.
    let light = VehicleParameters {
        mass_kg: truth.mass_kg / 1.2,
        ..truth.clone()
    };
    let small = VehicleParameters {
        wheel_radius_m: truth.wheel_radius_m / 1.05,
        ..truth.clone()
    };
    let slow = Planted {
        true_over_told: 1.05,
        ..PLAIN
    };
    for (believed, planted, adopted) in [
        (light, PLAIN, adopted("mass", 0.2, &[])),
        (small, slow, adopted("wheel_radius", 0.05, &[])),
    ] {
        let name = adopted.effect.name;
        let missing = drive(&believed, &truth, planted, SECONDS);
        let known = drive(&with(believed, &[adopted]), &truth, planted, SECONDS);
        assert_eq!(known.len(), plain.len(), "{name}");
        let (known, missing) = (difference(&plain, &known), difference(&plain, &missing));
        eprintln!("{name}: known {known} %, missing {missing} %");
        assert!(missing > 0.03, "{name}: missing {missing} %");
        assert!(known < 0.02 * missing, "{name}: {known} of {missing} %");
    }
}

#[test]
fn masses_told_on_the_bus_are_scaled_too() {
    use estimator_core::Signal;
    use test_kit::readings_drive::Drive;
    let heavier = with(by_force(), &[adopted("mass", 0.1, &[])]);
    let mut drive = Drive::of(heavier);
    let told = [
        (Signal::TractionForce, 4_000.0),
        (Signal::Mass, 30_000.0),
        (Signal::WheelSpeed, 20.0),
    ];
    for sample in drive.on(5.0, &told) {
        assert!((sample.load.mass_kg - 33_000.0).abs() < 0.1);
    }
}

/// Mean sigma of the live bias, of the scale and of the grade after some minutes.
fn sigmas(adopted: Adopted) -> [f32; 3] {
    let vehicle = by_force();
    let planted = Planted {
        told_n: |m| m.force_n,
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

#[test]
fn doubt_of_an_amount_is_doubt_of_the_grade() {
    for effect in CATALOGUE {
        let of_sigma = |sigmas_of_typical: f32| {
            sigmas(Adopted::new(
                effect,
                0.0,
                sigmas_of_typical * effect.typical,
            ))
        };
        let [sure, doubtful, more] = [0.0, 1.0, 3.0].map(of_sigma);
        let which = usize::from(matches!(effect.name, "mass" | "torque_scale"));
        eprintln!("{}: {sure:?} {doubtful:?} {more:?}", effect.name);
        assert!(
            sure[which] < doubtful[which] && doubtful[which] < more[which],
            "{}",
            effect.name
        );
        assert!(
            sure[2] < doubtful[2] && doubtful[2] < more[2],
            "{}",
            effect.name
        );
    }
}

/// What a fan's power is not known for shows when it comes on, and not before.
#[test]
fn doubt_comes_with_what_it_depends_on() {
    let vehicle = by_force();
    let fan = Effect::named("auxiliary_load").unwrap();
    let bias_sigma = |amount_sigma: f32| -> Vec<f32> {
        let mut adopted = Adopted::new(fan, 20_000.0, amount_sigma);
        assert!(adopted.set("with_fan", 1.0));
        let knows = with(vehicle.clone(), &[adopted]);
        drive(&knows, &vehicle, PLAIN, 110.0)
            .iter()
            .map(|estimate| estimate.bias_percent.sigma)
            .collect()
    };
    let (sure, doubtful) = (bias_sigma(0.0), bias_sigma(15_000.0));
    // The fan is on from 60 s, 1.2 km, on; 100 m later the doubt is there.
    let off = 400;
    let on = 600;
    assert_eq!(sure[..off], doubtful[..off]);
    // Of 15 kW at 90 % and 22 m/s, in % of the weight.
    let made = 100.0 * 15_000.0 * 0.9 / 21.9 / WEIGHT_N;
    let added = (doubtful[on].powi(2) - sure[on].powi(2)).sqrt();
    assert!(
        (0.8 * made..1.1 * made).contains(&added),
        "{added} of {made}"
    );
}

#[test]
fn what_was_learned_without_an_effect_is_not_kept_for_one() {
    let refused = |adopted: Adopted| {
        let vehicle = with(by_force(), &[adopted]);
        Estimator::<f32>::with_kept(vehicle, Tuning::default(), &KEPT).map(drop)
    };
    for effect in CATALOGUE {
        assert_eq!(
            refused(Adopted::new(effect, 0.0, 0.0)),
            Err(KeptError::Vehicle)
        );
    }

    // Every number of an effect tells vehicles apart.
    let wind = adopted("headwind", 3.0, &[]);
    let estimator = Estimator::<f32>::new(with(by_force(), &[wind]), Tuning::default()).unwrap();
    let kept = test_kit::hilly_drive::drive(estimator, 12_000, test_kit::hilly_drive::USUAL)
        .kept()
        .unwrap();
    let begins = |adopted: Adopted| kept.check_vehicle(&with(by_force(), &[adopted]));
    assert_eq!(begins(wind), Ok(()));
    for other in [
        adopted("headwind", 3.1, &[]),
        adopted("brake_drag", 3.0, &[]),
        adopted("headwind", 3.0, &[("from_deg", 0.0)]),
        Adopted {
            amount_sigma: 0.1,
            ..wind
        },
    ] {
        assert_eq!(begins(other), Err(KeptError::Vehicle));
    }
}
