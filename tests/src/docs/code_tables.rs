//! Tables of what the core declares: tuning, effects, signals.

use super::pipe_table::pipe_table;
use super::sensitivity_tables::costs;
use estimator_core::effect::{CATALOGUE, description_of};
use estimator_core::signal::messages;
use estimator_core::{Signal, Tuning};
use host_sim::error::Result;

/// Makes the table of the parameters of a group.
pub fn tuning(group: &str) -> Result<Option<String>> {
    let parameters = Tuning::PARAMETERS.iter().filter(|of| of.group == group);
    let cost = costs()?;
    let rows = parameters.map(|of| {
        [
            format!("`{}`", of.key),
            in_unit(
                &number(of.default.replace('_', "").parse().unwrap_or(f32::NAN)),
                of.unit,
            ),
            format!("{} to {}", number(of.low), number(of.high)),
            of.meaning.to_owned(),
            of.source.to_owned(),
            cost(of.key),
        ]
    });
    Ok(Some(pipe_table(
        ["key", "default", "range", "meaning", "source", "cost, %"],
        rows,
    )))
}

/// Makes the table of the catalogue of effects.
pub fn effects() -> Result<Option<String>> {
    let described = CATALOGUE
        .iter()
        .filter_map(|effect| Some((effect, description_of(effect)?)));
    let rows = described.map(|(effect, description)| {
        [
            effect.number.to_string(),
            format!("`{}`", effect.name),
            in_unit(&number(effect.typical), effect.unit),
            description.about.to_owned(),
            description.source.to_owned(),
        ]
    });
    Ok(Some(pipe_table(
        ["number", "name", "typical amount", "physics", "source"],
        rows,
    )))
}

/// Makes the table of the effects' parameters besides their amounts.
pub fn effect_parameters() -> Result<Option<String>> {
    let rows = CATALOGUE.iter().flat_map(|effect| {
        effect.parameters.iter().map(|parameter| {
            [
                format!("`{}`", effect.name),
                format!("`{}`", parameter.key),
                parameter.default.get().map_or("—".to_owned(), number),
                parameter.about.to_owned(),
            ]
        })
    });
    Ok(Some(pipe_table(
        ["effect", "parameter", "default", "meaning"],
        rows,
    )))
}

/// Makes the table of the ranges that a vehicle file may have for each effect.
pub fn effect_ranges() -> Result<Option<String>> {
    let rows = CATALOGUE.iter().map(|effect| {
        [
            format!("`{}`", effect.name),
            effect.range.words.to_owned(),
            or_none(effect.parameters.iter().map(|parameter| {
                let default = match parameter.default.get() {
                    Some(default) => format!(", default {}", number(default)),
                    None => String::new(),
                };
                format!("`{}` {}{default}", parameter.key, parameter.range.words)
            })),
        ]
    });
    Ok(Some(pipe_table(
        ["effect", "range of `amount`", "parameters and ranges"],
        rows,
    )))
}

/// Makes the table of all signals, in the order of readings of one time.
pub fn signals() -> Result<Option<String>> {
    let rows = Signal::ALL.iter().map(|signal| {
        let carriers = messages().filter(|message| message.signals().any(|of| of == *signal));
        [
            format!("`{signal:?}`"),
            format!("`{}`", signal.column()),
            or_none(carriers.map(|message| format!("{} {}", message.name(), message.pgn()))),
        ]
    });
    Ok(Some(pipe_table(
        ["signal", "column", "messages, with PGN"],
        rows,
    )))
}

fn or_none(items: impl Iterator<Item = String>) -> String {
    let items: Vec<String> = items.collect();
    if items.is_empty() {
        "—".to_owned()
    } else {
        items.join("; ")
    }
}

fn in_unit(number: &str, unit: &str) -> String {
    match unit {
        "1" => number.to_owned(),
        unit => format!("{number} {unit}"),
    }
}

/// Returns the shortest exact form of a number, with commas from 10,000 on.
fn number(number: f32) -> String {
    let whole = number.abs() >= 10_000.0 && number.fract() == 0.0;
    if whole && number > 0.0 {
        return super::pipe_table::with_commas(number as u32);
    }
    number.to_string().replace('-', "−")
}
