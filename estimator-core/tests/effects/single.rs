//! Each effect by itself: its force at known values, its derivative, its sign, its force where
//! inputs are unknown, and refused amounts.

use estimator_core::effect::{self, Acts, Bounds, CATALOGUE, MAX_EFFECT_PARAMETERS, Physics};
use estimator_core::sample::{EffectInputs, ForceInputs, Sample};
use estimator_core::vehicle::GRAVITY;
use estimator_core::{AdoptedEffect, CellEnd, Effect, Maybe, Model, VehicleParameters};
use test_kit::{sample, truck};

/// Truck A of the tables: 39 t, 6.0 m², c_r 0.007, at 80 km/h.
fn heavy() -> VehicleParameters {
    VehicleParameters {
        rolling_resistance: 0.007,
        ..truck()
    }
}

/// Truck B: 12 t, 5.5 m².
fn light() -> VehicleParameters {
    VehicleParameters {
        mass_kg: 12_000.0,
        drag_area_m2: 5.5,
        ..heavy()
    }
}

/// Returns a cell at constant speed on a slope, sine in %, with every input known.
fn cruise(vehicle: &VehicleParameters, slope_percent: f32) -> Sample {
    let speed_mps = 22.2;
    let weight_n = vehicle.mass_kg * GRAVITY;
    let drag_n = 0.5 * 1.2 * vehicle.drag_area_m2 * speed_mps * speed_mps;
    let plain = sample(100, 0.0, speed_mps);
    Sample {
        forces: ForceInputs {
            traction_n: drag_n + weight_n * (vehicle.rolling_resistance + 0.01 * slope_percent),
            mass_kg: vehicle.mass_kg,
            ..plain.forces
        },
        end: CellEnd {
            position_e7: Some((580_000_000, 150_000_000)),
            ..plain.end
        },
        effect_inputs: EffectInputs {
            driven_s: 0.0,
            yaw_rate_radps: Maybe::some(speed_mps / 500.0),
            course_deg: Maybe::some(90.0),
            gnss_speed_mps: Maybe::some(speed_mps),
            fan_percent: Maybe::some(100.0),
            ambient_celsius: Maybe::some(10.0),
            engaged: true,
        },
        ..plain
    }
}

fn named(name: &str) -> &'static Effect {
    effect::named(name).unwrap_or_else(|| panic!("no {name}"))
}

fn adopted(name: &str, amount: f32, parameters: &[(&str, f32)]) -> AdoptedEffect {
    let mut adopted = AdoptedEffect::new(named(name), amount, 0.0);
    for &(key, value) in parameters {
        assert!(adopted.set(key, value), "{name}: {key}");
    }
    adopted
}

/// Returns the slope that an effect reads as in a cell, %.
fn reads_percent(adopted: &AdoptedEffect, vehicle: &VehicleParameters, sample: &Sample) -> f32 {
    100.0 * adopted.force_n(vehicle, sample) / (sample.forces.mass_kg * GRAVITY)
}

/// Effect, amount, parameters, slope in %, and the slope that it reads as on A and B, %.
type Row = (
    &'static str,
    f32,
    &'static [(&'static str, f32)],
    f32,
    [f32; 2],
);

#[test]
fn forces_are_those_of_the_literature() {
    // Equivalent grade at 80 km/h, computed by hand: A, B.
    let flat = 0.0;
    #[rustfmt::skip]
    let table: [Row; 26] = [
        // The whole of the resistances.
        ("rolling_resistance", 0.007, &[], flat, [0.70, 0.70]),
        ("air_drag", 6.0, &[], flat, [0.464, 1.508]),
        ("tyre_warmup", 0.3, &[], flat, [0.21, 0.21]),
        ("tyre_warmup", 0.8, &[], flat, [0.56, 0.56]),
        ("headwind", 1.0, &[], flat, [0.043, 0.127]),
        ("headwind", 3.0, &[], flat, [0.134, 0.399]),
        ("headwind", 5.0, &[], flat, [0.233, 0.693]),
        ("headwind", -5.0, &[], flat, [-0.186, -0.553]),
        ("headwind", 3.0, &[("from_deg", 90.0)], flat, [0.134, 0.399]),
        ("headwind", 5.0, &[("from_deg", 270.0)], flat, [-0.186, -0.553]),
        ("headwind", 5.0, &[("from_deg", 0.0)], flat, [0.0, 0.0]),
        ("headwind", 6.0, &[("from_deg", 150.0)], flat, [0.134, 0.399]),
        ("cornering", 1.0 / 5.5, &[], flat, [0.184, 0.184]),
        ("driveline_loss", 0.05, &[], flat, [0.058, 0.104]),
        ("driveline_loss", 0.05, &[], 2.0, [0.158, 0.204]),
        ("auxiliary_load", 5_000.0, &[], flat, [0.059, 0.191]),
        ("auxiliary_load", 25_000.0, &[], flat, [0.294, 0.957]),
        ("mass", 0.1, &[], flat, [0.07, 0.07]),
        ("mass", 0.1, &[], 2.0, [0.27, 0.27]),
        ("mass", 0.1, &[], -2.0, [-0.13, -0.13]),
        ("torque_scale", -0.05, &[], 2.0, [0.158, 0.204]),
        ("wheel_radius", 0.01, &[], flat, [0.021, 0.048]),
        ("brake_drag", 382.46, &[], flat, [0.1, 0.325]),
        ("road_surface", 0.001, &[], flat, [0.1, 0.1]),
        // At 10 °C.
        ("tyre_temperature", 0.006, &[], flat, [0.063, 0.063]),
        ("tyre_temperature", 0.01, &[], 2.0, [0.105, 0.105]),
    ];
    for (name, amount, parameters, slope_percent, expected) in table {
        for (vehicle, expected) in [heavy(), light()].iter().zip(expected) {
            let sample = cruise(vehicle, slope_percent);
            let found = reads_percent(&adopted(name, amount, parameters), vehicle, &sample);
            assert!(
                (found - expected).abs() <= 0.0015 + 0.01 * expected.abs(),
                "{name} {amount} {parameters:?}: {found} %, expected {expected}"
            );
        }
    }
    let covered = |effect: &&Effect| table.iter().any(|row| row.0 == effect.name);
    assert!(CATALOGUE.iter().all(covered));
}

#[test]
fn names_are_unique_and_found() {
    for effect in CATALOGUE {
        assert_eq!(effect::named(effect.name), Some(effect));
        assert!(effect.parameters.len() <= MAX_EFFECT_PARAMETERS);
        assert!(effect.typical > 0.0 && effect.range.holds(effect.typical));
        let description = effect::description_of(effect).unwrap();
        let (about, source) = (description.about, description.source);
        for text in [effect.unit, about, source, effect.range.words] {
            assert!(!text.is_empty(), "{}", effect.name);
        }
        for parameter in effect.parameters {
            let default = parameter.default.get();
            assert!(default.is_none_or(|value| parameter.range.holds(value)));
        }
    }
    assert_eq!(effect::named("hysteresis"), None);
}

#[test]
fn a_range_holds_its_ends_and_no_nan() {
    let bounds = Bounds::new(-0.5, 2.0, "-0.5 to 2");
    for (value, is_within) in [
        (-0.5, true),
        (2.0, true),
        (-0.501, false),
        (2.001, false),
        (f32::NAN, false),
        (f32::INFINITY, false),
    ] {
        assert_eq!(bounds.holds(value), is_within, "{value}");
    }
}

#[test]
fn a_positive_amount_resists_and_one_of_torque_drives() {
    for effect in CATALOGUE {
        let vehicle = heavy();
        let force_n = AdoptedEffect::new(effect, effect.typical, 0.0)
            .force_n(&vehicle, &cruise(&vehicle, 1.0));
        let sign = if effect.acts == Acts::Traction {
            -1.0
        } else {
            1.0
        };
        assert!(sign * force_n > 0.0, "{}: {force_n} N", effect.name);
        let none = AdoptedEffect::new(effect, 0.0, 0.0).force_n(&vehicle, &cruise(&vehicle, 1.0));
        assert_eq!(none, 0.0, "{}", effect.name);
    }
}

#[test]
fn the_derivative_is_the_limit_of_the_quotient() {
    for effect in CATALOGUE {
        let vehicle = light();
        let sample = cruise(&vehicle, 1.0);
        let parameters = AdoptedEffect::new(effect, 0.0, 0.0).parameters;
        for amount in [0.0, effect.typical, -0.7 * effect.typical] {
            let force_n =
                |amount| f64::from(effect.force_n(&vehicle, &sample, &parameters, amount));
            let step = 0.02 * effect.typical;
            let quotient =
                (force_n(amount + step) - force_n(amount - step)) / (2.0 * f64::from(step));
            let derivative = f64::from(effect.derivative_n(&vehicle, &sample, &parameters, amount));
            assert!(
                (derivative - quotient).abs() <= 2e-3 * quotient.abs(),
                "{} at {amount}: {derivative}, quotient {quotient}",
                effect.name
            );
            let slope = f64::from(effect.slope_percent(&vehicle, &sample, &parameters, amount));
            let expected = 100.0 * derivative / (12_000.0 * f64::from(GRAVITY));
            assert!((slope - expected).abs() <= 1e-5 * expected.abs());
        }
    }
}

#[test]
fn unknown_inputs_make_no_force() {
    let vehicle = heavy();
    let known = cruise(&vehicle, 1.0);
    let blind = Sample {
        end: CellEnd {
            position_e7: None,
            ..known.end
        },
        effect_inputs: EffectInputs::default(),
        ..known
    };
    let there: &[(&str, f32)] = &[("latitude_deg", 58.0), ("longitude_deg", 15.0)];
    for (name, amount, parameters) in [
        ("headwind", 5.0, &[("from_deg", 90.0)][..]),
        ("cornering", 0.2, &[]),
        ("driveline_loss", 0.05, &[]),
        ("auxiliary_load", 5_000.0, &[]),
        ("road_surface", 0.001, there),
        ("tyre_temperature", 0.006, &[]),
    ] {
        let adopted = adopted(name, amount, parameters);
        assert!(adopted.force_n(&vehicle, &known) > 100.0, "{name}");
        assert_eq!(adopted.force_n(&vehicle, &blind), 0.0, "{name}");
    }
    // A stretch without a place is everywhere, also where no position is known.
    let everywhere = adopted("road_surface", 0.001, &[]);
    assert_eq!(
        everywhere.force_n(&vehicle, &blind),
        everywhere.force_n(&vehicle, &known)
    );
    // Without the parameter that it cannot do without, an effect has no force.
    for name in ["road_surface", "tyre_warmup"] {
        let mut adopted = adopted(name, 0.01, &[]);
        assert!(adopted.force_n(&vehicle, &known) > 0.0, "{name}");
        adopted.parameters = [Maybe::NONE; MAX_EFFECT_PARAMETERS];
        assert_eq!(adopted.force_n(&vehicle, &known), 0.0, "{name}");
    }
    // Non-finite inputs make no non-finite force.
    for value in [f32::NAN, f32::INFINITY] {
        let broken = Sample {
            end: CellEnd {
                speed_mps: value,
                ..known.end
            },
            forces: ForceInputs {
                traction_n: value,
                ..known.forces
            },
            ..known
        };
        for effect in CATALOGUE {
            let force_n =
                AdoptedEffect::new(effect, effect.typical, 0.1).force_n(&vehicle, &broken);
            assert!(force_n.is_finite(), "{}", effect.name);
        }
    }
}

#[test]
fn each_depends_on_its_declared_inputs() {
    let vehicle = heavy();
    let known = cruise(&vehicle, 0.0);
    let with = |change: &dyn Fn(&mut EffectInputs)| {
        let mut sample = known;
        change(&mut sample.effect_inputs);
        sample
    };
    let force = |adopted: &AdoptedEffect, sample: &Sample| adopted.force_n(&vehicle, sample);
    let near = |found: f32, expected: f32| {
        assert!((found / expected - 1.0).abs() < 1e-4, "{found} {expected}");
    };

    // Warm after three times its time.
    let tyres = adopted("tyre_warmup", 0.4, &[("time_s", 1_000.0)]);
    let later = with(&|c| c.driven_s = 3_000.0);
    near(
        force(&tyres, &later),
        force(&tyres, &known) * (-3.0_f32).exp(),
    );

    // A fan at a third, and a fan without a report.
    let fan = adopted("auxiliary_load", 22_200.0, &[("with_fan", 1.0)]);
    near(
        force(&fan, &with(&|c| c.fan_percent = Maybe::some(30.0))),
        300.0,
    );
    let unreported = with(&|c| c.fan_percent = Maybe::NONE);
    assert_eq!(force(&fan, &unreported), 0.0);
    // A constant load remains, but not through an open driveline.
    let always = adopted("auxiliary_load", 22_200.0, &[]);
    near(force(&always, &unreported), 1_000.0);
    assert_eq!(force(&always, &with(&|c| c.engaged = false)), 0.0);
    // No infinite force at standstill.
    let mut slow = known;
    slow.end.speed_mps = 0.01;
    near(force(&always, &slow), 11_100.0);

    // Left and right alike, and with the square of the speed and of the curvature.
    let bend = adopted("cornering", 0.2, &[]);
    let right = with(&|c| c.yaw_rate_radps = Maybe::some(-22.2 / 500.0));
    near(force(&bend, &right), force(&bend, &known));
    let half = with(&|c| c.yaw_rate_radps = Maybe::some(22.2 / 1_000.0));
    near(force(&bend, &half), 0.25 * force(&bend, &known));

    // Tyres have no excess at 25 °C, and less resistance in hotter air.
    let cold = adopted("tyre_temperature", 0.006, &[]);
    let at = |celsius: f32| with(&|c| c.ambient_celsius = Maybe::some(celsius));
    near(force(&cold, &at(-5.0)), 2.0 * force(&cold, &known));
    near(force(&cold, &at(32.5)), -0.5 * force(&cold, &known));
    assert_eq!(force(&cold, &at(25.0)), 0.0);

    // A driveline loses in either direction.
    let driveline = adopted("driveline_loss", 0.05, &[]);
    let mut overrun = known;
    overrun.forces.traction_n = -20_000.0;
    near(force(&driveline, &overrun), 1_000.0);

    // A measured force does not follow from a torque.
    let radius = adopted("wheel_radius", 0.01, &[]);
    let by_force = test_kit::by_force();
    let torque_part = force(&radius, &known) - radius.force_n(&by_force, &known);
    near(torque_part, known.forces.traction_n * (1.0 - 1.0 / 1.01));
}

#[test]
fn a_rough_stretch_is_where_it_is() {
    let vehicle = heavy();
    // 58° N: a degree is 111.1 km to the north and 58.9 km to the east.
    let rough = |parameters: &[(&str, f32)], latitude_deg: f64, longitude_deg: f64| {
        let mut sample = cruise(&vehicle, 0.0);
        let e7 = |deg: f64| (deg * 1e7) as i32;
        sample.end.position_e7 = Some((e7(latitude_deg), e7(longitude_deg)));
        adopted("road_surface", 0.002, parameters).force_n(&vehicle, &sample) > 0.0
    };
    let place = [
        ("latitude_deg", 58.0),
        ("longitude_deg", 15.0),
        ("length_m", 400.0),
    ];
    assert!(rough(&place, 58.0, 15.0));
    assert!(rough(&place, 58.0 + 190.0 / 111_100.0, 15.0));
    assert!(!rough(&place, 58.0 + 210.0 / 111_100.0, 15.0));
    assert!(rough(&place, 58.0, 15.0 - 190.0 / 58_900.0));
    assert!(!rough(&place, 58.0, 15.0 - 210.0 / 58_900.0));
    // At 58° everywhere where no longitude is given; everywhere where no coordinate is.
    assert!(rough(&place[..1], 58.0, -100.0));
    assert!(!rough(&place[..1], 59.0, -100.0));
    assert!(rough(&[], -30.0, 170.0));
}

#[test]
fn impossible_amounts_are_refused_by_name() {
    for effect in CATALOGUE {
        let refusal = |change: &dyn Fn(&mut AdoptedEffect)| {
            let mut adopted =
                AdoptedEffect::new(effect, 0.5 * effect.typical, 0.1 * effect.typical);
            change(&mut adopted);
            let mut model = Model::from(heavy());
            model.effects.adopt(adopted).unwrap();
            model.check().map_err(|error| error.to_string())
        };
        assert_eq!(refusal(&|_| {}), Ok(()));
        let over = effect.range.high * 1.01;
        let under = effect.range.low - 0.01 * effect.range.high;
        for value in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, over, under] {
            let error = refusal(&|adopted| adopted.amount = value).unwrap_err();
            let name = effect.name;
            assert!(
                error.starts_with(&format!("effects.{name}.amount = ")),
                "{error}"
            );
            assert!(error.ends_with(effect.range.words), "{error}");
        }
        for value in [f32::NAN, f32::INFINITY, -1e-6, 1e9] {
            let error = refusal(&|adopted| adopted.amount_sigma = value).unwrap_err();
            assert!(error.contains("amount_sigma = "), "{error}");
        }
        for parameter in effect.parameters {
            for value in [f32::INFINITY, parameter.range.high + 1e6] {
                let error = refusal(&|adopted| assert!(adopted.set(parameter.key, value)));
                let error = error.unwrap_err();
                assert!(error.contains(parameter.key), "{error}");
            }
        }
        assert!(!AdoptedEffect::new(effect, 0.0, 0.0).set("speed_kmh", 1.0));
    }
}

#[test]
fn adopted_forces_add_up_and_factors_are_no_forces() {
    let vehicle = heavy();
    let sample = cruise(&vehicle, 1.0);
    let mut effects = Model::from(heavy()).effects;
    let [air, tyres, mass] = [("air_drag", 0.6), ("tyre_warmup", 0.3), ("mass", 0.1)]
        .map(|(name, amount)| adopted(name, amount, &[]));
    for each in [air, tyres, mass] {
        effects.adopt(each).unwrap();
    }
    let expected_n = air.force_n(&vehicle, &sample) + tyres.force_n(&vehicle, &sample);
    let found_n = effects.force_n(&vehicle, &sample);
    assert!(
        (found_n / expected_n - 1.0).abs() < 1e-6,
        "{found_n} {expected_n}"
    );
    assert_eq!(effects.factor(Acts::Mass), 1.1);
    assert_eq!(effects.factor(Acts::Resists), 1.0);
}

#[test]
fn an_effect_beyond_the_catalogue_is_refused_where_there_is_no_room() {
    static OWN: Effect = Effect {
        number: 250,
        name: "own",
        unit: "N",
        typical: 100.0,
        range: Bounds::new(0.0, 1_000.0, "0 to 1000 N"),
        parameters: &[],
        acts: Acts::Resists,
        physics: Physics::PerUnit(|_, _, _| 1.0),
    };
    let own = AdoptedEffect::new(&OWN, 100.0, 0.0);
    let mut effects = Model::from(heavy()).effects;
    for effect in &CATALOGUE[1..] {
        effects.adopt(AdoptedEffect::new(effect, 0.1, 0.0)).unwrap();
    }
    let mut with_own = effects.clone();
    assert_eq!(with_own.adopt(own), Ok(()));
    effects
        .adopt(AdoptedEffect::new(CATALOGUE[0], 0.1, 0.0))
        .unwrap();
    let full = effects.clone();
    assert_eq!(effects.adopt(own), Err(own));
    assert_eq!(effects, full);
}

#[test]
fn an_effect_is_adopted_once() {
    let mut first = Model::from(heavy());
    let mut second = Model::from(heavy());
    for effect in CATALOGUE {
        first
            .effects
            .adopt(AdoptedEffect::new(effect, 0.1, 0.0))
            .unwrap();
    }
    for effect in CATALOGUE.into_iter().rev() {
        let adopted = AdoptedEffect::new(effect, 0.3, 0.0);
        second.effects.adopt(adopted).unwrap();
        let adopted = AdoptedEffect::new(effect, 0.1, 0.0);
        second.effects.adopt(adopted).unwrap();
    }
    // For any order.
    assert_eq!(first, second);
    assert_eq!(first.effects.iter().count(), CATALOGUE.len());
    assert!(!first.effects.is_empty() && Model::from(heavy()).effects.is_empty());
}
