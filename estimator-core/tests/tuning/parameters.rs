//! Every parameter of the tuning: its line in the table, and reading and setting it by key.

use estimator_core::Tuning;
use estimator_core::tuning::{TuningError, TuningParameter};
use proptest::prelude::*;
use std::collections::BTreeSet;

fn name(parameter: &TuningParameter) -> String {
    format!("{}.{}", parameter.group, parameter.key)
}

/// Returns a number of the source text: `300_000`, `1e-4`, `-1.5`.
fn number(text: &str) -> f32 {
    text.replace('_', "").parse().unwrap()
}

/// Returns whether only whole numbers are possible: a default without a decimal point.
fn is_whole(parameter: &TuningParameter) -> bool {
    !parameter.default.contains('.')
}

fn get(tuning: &Tuning, parameter: &TuningParameter) -> f64 {
    let value = tuning.get(parameter.group, parameter.key);
    value.unwrap_or_else(|| panic!("no {}", name(parameter)))
}

/// Returns a possible value: `part` of the range above its lower end.
fn within(parameter: &TuningParameter, part: f32) -> f64 {
    let value = parameter.low + part * (parameter.high - parameter.low);
    let value = value.clamp(parameter.low, parameter.high);
    if is_whole(parameter) {
        value.floor().into()
    } else {
        value.into()
    }
}

/// Returns the values of all parameters, in the order of the table.
fn values(tuning: &Tuning) -> Vec<f64> {
    Tuning::PARAMETERS
        .iter()
        .map(|parameter| get(tuning, parameter))
        .collect()
}

/// Checks that a value is refused, and that the refusal changes nothing.
fn assert_refused(group: &str, key: &str, value: f64, expected: TuningError) {
    let mut tuning = Tuning::default();
    assert_eq!(
        tuning.set(group, key, value),
        Err(expected),
        "{group}.{key} = {value}"
    );
    assert_eq!(tuning, Tuning::default(), "{group}.{key} = {value}");
}

#[test]
fn every_parameter_is_found_with_its_default() {
    let tuning = Tuning::default();
    assert!(!Tuning::PARAMETERS.is_empty());
    for parameter in Tuning::PARAMETERS {
        let default = number(parameter.default);
        assert_eq!(
            get(&tuning, parameter),
            f64::from(default),
            "{}",
            name(parameter)
        );
        assert!(
            (parameter.low..=parameter.high).contains(&default),
            "{}",
            name(parameter)
        );
    }
}

#[test]
fn every_parameter_is_described() {
    for parameter in Tuning::PARAMETERS {
        let TuningParameter {
            group,
            key,
            unit,
            meaning,
            source,
            ..
        } = *parameter;
        for text in [group, key, unit, meaning, source] {
            assert!(!text.trim().is_empty(), "{}", name(parameter));
        }
        assert_eq!(key.ends_with("_ms"), unit == "ms", "{}", name(parameter));
        assert!(parameter.low < parameter.high, "{}", name(parameter));
    }
}

#[test]
fn keys_are_unique() {
    let names: BTreeSet<String> = Tuning::PARAMETERS.iter().map(name).collect();
    assert_eq!(names.len(), Tuning::PARAMETERS.len());
}

#[test]
fn a_value_that_is_set_is_returned_and_moves_nothing_else() {
    let usual = values(&Tuning::default());
    for (at, parameter) in Tuning::PARAMETERS.iter().enumerate() {
        for part in [0.0, 0.37, 0.61, 1.0] {
            let mut tuning = Tuning::default();
            let value = within(parameter, part);
            let (group, key) = (parameter.group, parameter.key);
            assert_eq!(
                tuning.set(group, key, value),
                Ok(()),
                "{} = {value}",
                name(parameter)
            );
            let mut expected = usual.clone();
            expected[at] = value;
            assert_eq!(values(&tuning), expected, "{} = {value}", name(parameter));
        }
    }
}

/// A tuning file may repeat what is printed.
#[test]
fn a_value_that_is_read_can_be_set() {
    let mut tuning = Tuning::default();
    for parameter in Tuning::PARAMETERS {
        let value = get(&tuning, parameter);
        let result = tuning.set(parameter.group, parameter.key, value);
        assert_eq!(result, Ok(()), "{} = {value}", name(parameter));
    }
    assert_eq!(tuning, Tuning::default());
}

/// A tuning file holds decimal numbers, which are not rounded to single precision.
#[test]
fn default_and_limits_can_be_set_as_they_are_written() {
    let mut refused = Vec::new();
    for parameter in Tuning::PARAMETERS {
        let texts = [
            parameter.default.replace('_', ""),
            parameter.low.to_string(),
            parameter.high.to_string(),
        ];
        for text in texts {
            let value = text.parse().unwrap();
            let result = Tuning::default().set(parameter.group, parameter.key, value);
            if let Err(error) = result {
                refused.push(format!("{} = {text}: {error}", name(parameter)));
            }
        }
    }
    assert!(refused.is_empty(), "{refused:#?}");
}

#[test]
fn values_outside_the_range_are_refused() {
    for parameter in Tuning::PARAMETERS {
        let TuningParameter { low, high, .. } = *parameter;
        let outside = TuningError::OutOfRange { low, high };
        for value in [
            f64::from(low) - 1e-3 * f64::from(high - low) - 1.0,
            f64::from(high) + 1e-3 * f64::from(high - low) + 1.0,
            f64::from(low.next_down()),
            f64::from(high.next_up()),
            f64::MAX,
            f64::MIN,
            f64::INFINITY,
            f64::NEG_INFINITY,
            f64::NAN,
        ] {
            assert_refused(parameter.group, parameter.key, value, outside);
        }
    }
}

#[test]
fn unknown_keys_are_refused() {
    let unknown = |group: &str, key: &str| {
        assert_eq!(Tuning::default().get(group, key), None, "{group}.{key}");
        assert_refused(group, key, 1.0, TuningError::Unknown);
    };
    for (group, key) in [
        ("", ""),
        ("gates", ""),
        ("", "drift_fixes"),
        ("gate", "drift_fixes"),
    ] {
        unknown(group, key);
    }
    for parameter in Tuning::PARAMETERS {
        let TuningParameter { group, key, .. } = *parameter;
        unknown(group, &key.to_uppercase());
        unknown(group, &format!("{key} "));
        // A time without its unit.
        if let Some(bare) = key.strip_suffix("_ms") {
            unknown(group, bare);
        }
        // The key of another group.
        for other in Tuning::PARAMETERS {
            if Tuning::PARAMETERS
                .iter()
                .all(|known| (known.group, known.key) != (other.group, key))
            {
                unknown(other.group, key);
            }
        }
    }
}

#[test]
fn a_fraction_is_refused_where_only_whole_numbers_are_possible() {
    let mut whole = 0;
    for parameter in Tuning::PARAMETERS.iter().filter(|known| is_whole(known)) {
        let low = f64::from(parameter.low);
        for value in [low + 0.5, low + 1.000_1, low + 1.0 - 1e-9] {
            assert_refused(parameter.group, parameter.key, value, TuningError::NotWhole);
        }
        whole += 1;
    }
    assert!(whole > 10 && whole < Tuning::PARAMETERS.len(), "{whole}");
}

#[test]
fn refusals_say_what_is_expected() {
    for (refusal, words) in [
        (TuningError::Unknown, "unknown key"),
        (
            TuningError::OutOfRange {
                low: 0.5,
                high: 20.0,
            },
            "from 0.5 to 20",
        ),
        (TuningError::NotWhole, "whole number"),
    ] {
        assert!(refusal.to_string().contains(words), "{refusal}");
    }
}

proptest! {
    /// For any value: it is set up to the rounding of its type, or the tuning is unchanged.
    #[test]
    fn any_value_is_set_or_changes_nothing(
        at in 0..Tuning::PARAMETERS.len(),
        value in prop_oneof![any::<f64>(), -10.0..1_000.0_f64, (0..10_000_u32).prop_map(f64::from)],
    ) {
        let parameter = &Tuning::PARAMETERS[at];
        let mut tuning = Tuning::default();
        match tuning.set(parameter.group, parameter.key, value) {
            Ok(()) if is_whole(parameter) => prop_assert_eq!(get(&tuning, parameter), value),
            Ok(()) => prop_assert_eq!(get(&tuning, parameter), f64::from(value as f32)),
            Err(error) => {
                prop_assert_ne!(error, TuningError::Unknown);
                prop_assert_eq!(tuning, Tuning::default());
            }
        }
    }
}
