//! The vehicle file with a comment at each value.

use super::estimate::two_digits;
use super::identified::{Identified, IdentifiedValue, Origin};
use std::collections::BTreeMap;

/// Returns the text of the vehicle file. Each value has a comment: read, measured ± sigma, or
/// assumed.
#[must_use]
pub fn text(found: &Identified) -> String {
    let values: BTreeMap<&str, &IdentifiedValue> = found
        .values
        .iter()
        .map(|value| (value.key.as_str(), value))
        .collect();
    let mut text = format!(
        "# Identified from recordings, with what is usual for {} where they do not tell.\n",
        found.class
    );
    for unknown in &found.unknown {
        text += &format!("# Not known: {}. {}\n", unknown.what, unknown.advice);
    }
    for delay in &found.delays {
        text += &format!("# {}\n", delay.sentence());
    }
    let mut table = String::new();
    let mut elements: BTreeMap<String, usize> = BTreeMap::new();
    for line in found.vehicle.to_toml().lines() {
        if let Some(name) = line.strip_prefix("[[").and_then(|l| l.strip_suffix("]]")) {
            let number = elements.entry(name.to_owned()).or_default();
            table = format!("{name}[{number}]");
            *number += 1;
        } else if let Some(name) = line.strip_prefix('[').and_then(|l| l.strip_suffix(']')) {
            name.clone_into(&mut table);
        }
        text += line;
        let key = line
            .split_once(" = ")
            .map(|(key, _)| format!("{table}.{key}"));
        if let Some(value) = key.and_then(|key| values.get(key.as_str()).copied()) {
            text += &format!("  # {}", comment(value));
        }
        text.push('\n');
    }
    text
}

/// Returns the words about a value: `measured ± 0.02, engine speed over wheel speed`.
#[must_use]
pub fn comment(value: &IdentifiedValue) -> String {
    let origin = match value.origin {
        Origin::Read => "read",
        Origin::Measured => "measured",
        Origin::Assumed => "assumed",
    };
    let sigma = match value.origin {
        Origin::Read => String::new(),
        _ => format!(" ± {}", two_digits(value.sigma)),
    };
    format!("{origin}{sigma}: {}", value.how)
}
