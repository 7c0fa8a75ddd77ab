//! The sections of the page.

use super::words::{if_known, in_a_sentence, separated_by, short, three_digits};
use crate::diagnose::findings::Diagnosis;
use crate::diagnose::judgement::{Judgement, WINDOW_M};
use crate::report::page::{Figure, Section, Table};
use crate::report::plot::{Mark, Plot, Series, colour};
use estimator_core::effect::description_of;

pub(super) fn residual_section(diagnosis: &Diagnosis) -> Section {
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

pub(super) fn candidates_section(diagnosis: &Diagnosis) -> Section {
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

pub(super) fn adopted_section(diagnosis: &Diagnosis) -> Section {
    let mut words = vec![in_a_sentence(diagnosis)];
    for finding in &diagnosis.findings {
        let effect = finding.adopted.effect;
        let about = description_of(effect).map_or("", |description| description.about);
        words.push(format!("{}: {about}", effect.name));
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
