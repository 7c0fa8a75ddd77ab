//! A few cases of the bench; `cross-tests`' example `diagnosis_bench` runs all.

use cross_tests::diagnosed::{CaseOutcome, DiagnosisCase, Verdict, cases, effects, table};
use cross_tests::planted::CLEAN;
use std::collections::BTreeSet;
use std::slice;

/// Effect, size in %, truck, and the accepted verdicts. Effects that differ little at one speed and
/// load may be found as a group.
const CASES: [(&str, f64, &str, &[Verdict]); 8] = [
    (CLEAN, 0.0, "A", &[Verdict::Named]),
    (CLEAN, 0.0, "B", &[Verdict::Named]),
    ("cornering", 0.1, "B", &[Verdict::Named]),
    ("fan", 0.3, "A", &[Verdict::Named]),
    (
        "rolling_resistance",
        0.1,
        "A",
        &[Verdict::Named, Verdict::InGroup],
    ),
    ("wheel_radius", 1.0, "A", &[Verdict::Named]),
    ("torque_hysteresis", 0.3, "A", &[Verdict::Named]),
    ("tyre_temperature", 0.1, "A", &[Verdict::Named]),
];

#[test]
fn undeclared_effects_are_found_and_none_in_clean_logs() {
    let asked = CASES.map(|(effect, size_percent, truck, _)| DiagnosisCase {
        effect: effect.to_owned(),
        size_percent,
        truck,
        seed: 1,
    });
    let outcomes = table(&asked, |_| ()).unwrap();
    let mut wrong = Vec::new();
    for (outcome, (.., right)) in outcomes.iter().zip(CASES) {
        if !right.contains(&outcome.verdict()) || !improves_the_model(outcome) {
            wrong.push(described(outcome));
        }
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
}

/// Returns whether the diagnosis keeps a right model as it is and improves a wrong one much.
fn improves_the_model(outcome: &CaseOutcome) -> bool {
    let diagnosis = &outcome.diagnosis;
    let (before, after) = (diagnosis.before.rmse_percent, diagnosis.after.rmse_percent);
    match outcome.case.effect.as_str() {
        CLEAN => before < 0.1 && (after - before).abs() < 1e-9,
        // The catalogue does not have this effect. The model must not become worse.
        "torque_hysteresis" => after < 1.02 * before,
        "wheel_radius" => {
            let radius = &diagnosis.findings[0].adopted;
            (radius.amount - 0.01).abs() < 1e-3 && after < 0.5 * before
        }
        _ => after < 0.6 * before,
    }
}

fn described(outcome: &CaseOutcome) -> String {
    let diagnosis = &outcome.diagnosis;
    let found = diagnosis.findings.iter();
    format!(
        "{:?}: {:?}, adopted {:?}, unexplained {:?}, {:.3} % before and {:.3} % after",
        outcome.case,
        outcome.verdict(),
        found
            .map(|f| (f.adopted.effect.name, f.adopted.amount, &f.group))
            .collect::<Vec<_>>(),
        diagnosis.unexplained,
        diagnosis.before.rmse_percent,
        diagnosis.after.rmse_percent,
    )
}

#[test]
fn the_full_bench_has_every_effect_and_size_on_both_trucks() {
    let all: Vec<String> = effects().map(str::to_owned).collect();
    let asked = cases(&all, &[0.1, 0.3], 3).unwrap();
    // Thirteen effects of the catalogue, the fan, three effects outside it and six pairs, each in two
    // sizes, and clean logs.
    assert_eq!(asked.len(), (23 * 2 + 1) * 2 * 3);
    let sizes = |effect: &str| {
        let own = asked.iter().filter(|case| case.effect == effect);
        let mut sizes: Vec<f64> = own.map(|case| case.size_percent).collect();
        sizes.dedup();
        sizes
    };
    assert_eq!(sizes("mass"), [0.1, 0.3]);
    assert_eq!(sizes("wheel_radius"), [1.0, 3.0]);
    assert_eq!(sizes(CLEAN), [0.0]);
    let less = cases(&all, &[-0.3], 1).unwrap();
    let effects: BTreeSet<&str> = less.iter().map(|case| case.effect.as_str()).collect();
    assert!(effects.contains("mass") && effects.contains("headwind"));
    assert!(!effects.contains("brake_drag") && !effects.contains("road_surface+fan"));
    let error = cases(slice::from_ref(&"gravity".to_owned()), &[0.1], 1).unwrap_err();
    assert!(error.to_string().contains("gravity"), "{error}");
}
