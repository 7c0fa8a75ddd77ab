//! The content of report.json.

use super::signal;
use super::words::separated_by;
use crate::diagnose::findings::{Diagnosis, FittedAmounts};
use crate::diagnose::judgement::Judgement;
use serde_json::{Value, json};

/// Returns a number for JSON: `null` if it is not finite.
fn number(value: f64) -> Value {
    serde_json::Number::from_f64(value).map_or(Value::Null, Value::Number)
}

fn errors(judgement: &Judgement) -> Value {
    let interval = |(low, high): (f64, f64)| [number(low), number(high)];
    json!({
        "rmse_percent": number(judgement.rmse_percent),
        "rmse_interval_percent": interval(judgement.rmse_interval),
        "bias_percent": number(judgement.bias_percent),
        "bias_interval_percent": interval(judgement.bias_interval),
        "drift_m_per_km": number(judgement.drift_m_per_km),
        "windows": judgement.windows.len(),
    })
}

/// Returns fitted amounts, each with its row of the covariance.
fn amounts(fitted: &FittedAmounts) -> Value {
    let rows = fitted.covariance.row_iter();
    let named = fitted.names.iter().zip(&fitted.amounts).zip(rows);
    named
        .map(|((of, amount), row)| {
            let row: Vec<Value> = row.iter().map(|value| number(*value)).collect();
            json!({ "of": of, "amount": number(*amount), "covariance": row })
        })
        .collect()
}

/// Returns the content of report.json.
#[must_use]
pub fn to_json(diagnosis: &Diagnosis) -> Value {
    let adopted: Vec<Value> = diagnosis
        .findings
        .iter()
        .map(|finding| {
            let details: serde_json::Map<String, Value> = finding
                .adopted
                .given_parameters()
                .map(|(key, value)| (key.to_owned(), number(f64::from(value))))
                .collect();
            json!({
                "name": finding.adopted.effect.name,
                "amount": number(f64::from(finding.adopted.amount)),
                "sigma": number(f64::from(finding.adopted.amount_sigma)),
                "unit": finding.adopted.effect.unit,
                "details": details,
                "evidence": number(finding.evidence),
                "amounts": finding.fitted.as_ref().map(amounts),
                "cannot_be_told_from": finding.group,
                "nor_from_both": finding.pairs,
                "told_apart_by": finding.group.iter().filter_map(|name| separated_by(name)).collect::<Vec<_>>(),
            })
        })
        .collect();
    let candidates: Vec<Value> = diagnosis
        .candidates
        .iter()
        .map(|case| {
            json!({
                "name": case.name,
                "amount": number(case.amount),
                "sigma": number(case.sigma),
                "unit": case.unit,
                "evidence": number(case.evidence),
                "holdout_before_percent": number(diagnosis.before.rmse_percent),
                "holdout_after_percent": number(case.after.rmse_percent),
            })
        })
        .collect();
    let first = diagnosis.unexplained.first();
    json!({
        "adopted": adopted,
        "candidates": candidates,
        "before": errors(&diagnosis.before),
        "after": errors(&diagnosis.after),
        "terrain": diagnosis.terrain.as_ref().map(|[before, after]| json!({
            "before": errors(before),
            "after": errors(after),
        })),
        "reference_signal": signal::to_json(diagnosis),
        "judged_on_runs_to_fit": diagnosis.judged_on_fitted,
        "unexplained": {
            "rms_percent": number(first.map_or(0.0, |rest| rest.rms_percent)),
            "depends_on": first.map(|rest| rest.depends_on.clone()),
        },
        "unexplained_all": diagnosis.unexplained.iter().map(|rest| json!({
            "rms_percent": number(rest.rms_percent),
            "depends_on": rest.depends_on,
            "evidence": number(rest.evidence),
        })).collect::<Vec<_>>(),
    })
}
