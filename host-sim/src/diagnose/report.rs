//! report.json and the page.

use super::findings::{Diagnosis, Finding, FittedAmounts};
use super::judgement::{Judgement, WINDOW_M};
use crate::error::Result;
use crate::files::output::stage_text;
use crate::report::page::{Figure, PAGE, Page, Section, Table};
use crate::report::plot::{Mark, Plot, Series, colour};
use estimator_core::effect::{self, search_of};
use serde_json::{Value, json};
use std::path::{Path, PathBuf};

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

const VEHICLE: &str = "vehicle.toml";
const JSON: &str = "report.json";
/// Files that [`write()`] writes, besides those of its tables and figures.
pub const FILES: [&str; 3] = [VEHICLE, JSON, PAGE];

/// Writes report.json, vehicle.toml and the page with its tables and figures, all or none.
///
/// # Errors
/// Returns an error if a file cannot be written.
pub fn write(diagnosis: &Diagnosis, folder: &Path) -> Result<PathBuf> {
    let mut files = page(diagnosis).stage(folder)?;
    let vehicle = folder.join(VEHICLE);
    files.push(stage_text(&vehicle, &diagnosis.vehicle.to_toml())?);
    let json = format!("{:#}\n", to_json(diagnosis));
    files.push(stage_text(&folder.join(JSON), &json)?);
    for file in files {
        file.commit()?;
    }
    Ok(folder.join(PAGE))
}

/// Returns the files that [`write()`] writes.
#[must_use]
pub fn files(diagnosis: &Diagnosis, folder: &Path) -> Vec<PathBuf> {
    let mut files = page(diagnosis).files(folder);
    files.extend([VEHICLE, JSON].map(|name| folder.join(name)));
    files
}

fn page(diagnosis: &Diagnosis) -> Page {
    Page {
        title: format!("What the model of {} lacks", diagnosis.vehicle.name),
        lead: in_a_sentence(diagnosis),
        sections: vec![
            residual_section(diagnosis),
            candidates_section(diagnosis),
            adopted_section(diagnosis),
        ],
    }
}

/// Returns the text of a number, or that it is not known: too few windows have no interval, and none
/// has no error.
fn if_known(number: f64, text: String) -> String {
    if number.is_finite() {
        text
    } else {
        "unknown".to_owned()
    }
}

/// Returns a number with three decimals, or that it is not known.
#[must_use]
pub fn three_digits(number: f64) -> String {
    if_known(number, format!("{number:.3}"))
}

/// Returns the errors before and after, or that there are none.
fn errors_in_words(diagnosis: &Diagnosis) -> String {
    if diagnosis.before.windows.is_empty() {
        return format!(" No drive has a valid window of {WINDOW_M:.0} m to judge by.");
    }
    format!(
        " On drives {}, the RMSE of the bare model is {:.3} % grade before and {:.3} % after \
         (windows of {WINDOW_M:.0} m); its altitude drifts by {:+.2} and {:+.2} m per km.",
        if diagnosis.judged_on_fitted {
            "that were fitted too"
        } else {
            "held out"
        },
        diagnosis.before.rmse_percent,
        diagnosis.after.rmse_percent,
        diagnosis.before.drift_m_per_km,
        diagnosis.after.drift_m_per_km,
    )
}

/// Returns a summary in words.
#[must_use]
pub fn in_a_sentence(diagnosis: &Diagnosis) -> String {
    let names: Vec<String> = diagnosis.findings.iter().map(amount_in_words).collect();
    let mut words = if names.is_empty() {
        "Nothing is adopted: the drives give no evidence of an effect beyond the model.".to_owned()
    } else {
        format!("Adopted: {}.", names.join("; "))
    };
    words += &errors_in_words(diagnosis);
    for rest in &diagnosis.unexplained {
        words += &format!(
            " Unexplained: {:.2} % that depends on {}.",
            rest.rms_percent, rest.depends_on
        );
    }
    words
}

fn amount_in_words(finding: &Finding) -> String {
    let adopted = &finding.adopted;
    let unit = match adopted.effect.unit {
        "1" => String::new(),
        unit => format!(" {unit}"),
    };
    let mut words = format!(
        "{} {}{unit} ± {}",
        adopted.effect.name,
        short(f64::from(adopted.amount)),
        short(f64::from(adopted.amount_sigma)),
    );
    if !finding.group.is_empty() {
        words += &format!(
            " (or {}, which these drives cannot separate from it)",
            finding.group.join(", ")
        );
    }
    words
}

/// Formats a number with three significant digits.
fn short(value: f64) -> String {
    let digits = if value == 0.0 {
        0
    } else {
        (2.0 - value.abs().log10().floor()).clamp(0.0, 6.0) as usize
    };
    format!("{value:.digits$}")
}

fn residual_section(diagnosis: &Diagnosis) -> Section {
    let series = |judgement: &Judgement, name: &str, colour| {
        let points = judgement.windows.iter().enumerate();
        Series::line(
            name,
            colour,
            points.map(|(i, error_percent)| (i as f64 * WINDOW_M * 1e-3, *error_percent)),
        )
    };
    let plot = Plot::new(
        "way on the drives judged (km)",
        "model less reference (% grade)",
    )
    .with(series(&diagnosis.before, "before", colour::CYCLE[0]))
    .with(series(&diagnosis.after, "after", colour::CYCLE[1]).drawn(Mark::Dashed));
    Section {
        heading: "Residual, before and after".to_owned(),
        words: vec![format!(
            "The slope of the force balance alone, less that of the reference, over windows of \
             {WINDOW_M:.0} m in which the model is valid. The reference is the given map, else \
             the map of the other drives in this direction, else the drive's own estimate."
        )],
        tables: vec![before_after(diagnosis)],
        figures: vec![Figure::new(
            "residual",
            &plot,
            "The drives one after the other.",
        )],
        ..Section::default()
    }
}

fn before_after(diagnosis: &Diagnosis) -> Table {
    let header = [
        "bare model",
        "RMSE %",
        "90 % within",
        "bias %",
        "90 % within",
        "drift m/km",
        "windows",
    ];
    let row = |name: &str, j: &Judgement| {
        let interval = |(low, high): (f64, f64)| {
            let text = format!("{low:+.3} to {high:+.3}");
            if_known(low + high, text)
        };
        vec![
            name.to_owned(),
            if_known(j.rmse_percent, format!("{:.3}", j.rmse_percent)),
            interval(j.rmse_interval),
            if_known(j.bias_percent, format!("{:+.3}", j.bias_percent)),
            interval(j.bias_interval),
            if_known(j.drift_m_per_km, format!("{:+.2}", j.drift_m_per_km)),
            j.windows.len().to_string(),
        ]
    };
    Table::new(
        "before_after",
        "Intervals by block bootstrap over 3 km.",
        &header,
    )
    .with_rows([
        row("before", &diagnosis.before),
        row("after", &diagnosis.after),
    ])
}

fn candidates_section(diagnosis: &Diagnosis) -> Section {
    let header = [
        "effect",
        "amount",
        "sigma",
        "unit",
        "evidence",
        "RMSE before %",
        "with it alone %",
    ];
    let caption = "Evidence is twice the logarithm of the Bayes factor against no effect, \
                   corrected for the number of choices within an effect: above 6 is strong. Each \
                   effect stands alone here; the adopted effects are below.";
    let rows = diagnosis.candidates.iter().map(|case| {
        vec![
            case.name.to_owned(),
            short(case.amount),
            short(case.sigma),
            case.unit.to_owned(),
            format!("{:+.1}", case.evidence),
            three_digits(diagnosis.before.rmse_percent),
            three_digits(case.after.rmse_percent),
        ]
    });
    Section {
        heading: "Each candidate's case".to_owned(),
        words: vec![
            "Every effect predicts a change of the reported GNSS altitudes. The test compares \
             that change with the errors due to GNSS, wind and road."
                .to_owned(),
        ],
        tables: vec![Table::new("candidates", caption, &header).with_rows(rows)],
        ..Section::default()
    }
}

/// Returns the data that would separate an effect from similar ones.
fn separated_by(name: &str) -> Option<&'static str> {
    Some(search_of(effect::named(name)?)?.separated_by)
}

fn adopted_section(diagnosis: &Diagnosis) -> Section {
    let mut words = vec![in_a_sentence(diagnosis)];
    for finding in &diagnosis.findings {
        words.push(format!(
            "{}: {}",
            finding.adopted.effect.name, finding.adopted.effect.about
        ));
        for name in &finding.group {
            if let Some(data) = separated_by(name) {
                words.push(format!("Data that would separate {name} from it: {data}."));
            }
        }
    }
    if !diagnosis.unexplained.is_empty() {
        words.push(
            "An unexplained dependence needs a new effect: a file in estimator-core/src/effect. \
             The documentation of that module shows how to write one."
                .to_owned(),
        );
    }
    Section {
        heading: "What is adopted".to_owned(),
        words,
        figures: diagnosis
            .unexplained
            .iter()
            .filter_map(|rest| rest.figure.clone())
            .collect(),
        ..Section::default()
    }
}
