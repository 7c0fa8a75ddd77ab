//! `tuning.toml`: values for the parameters of the estimator.
//!
//! The tables are the groups of [`Tuning`], the keys its parameters. A missing key keeps its
//! default. `docs/tuning.md` lists every key with its default, range, unit, meaning and source.
//!
//! ```toml
//! [measurement_noise]
//! speed_sigma_mps = 0.02
//! [hold_times]
//! hold_ms = 1500
//! ```

use super::kind::{self, Kind};
use super::limits::read_text;
use crate::error::{Error, Result};
use estimator_core::Tuning;
use estimator_core::tuning::TuningError;
use std::path::Path;

/// Reads a tuning file. Returns the defaults if `path` is `None`.
///
/// # Errors Returns an error if the file cannot be read, and for unknown tables, unknown keys and
/// values out of range. The message states the expected value.
pub fn read_or_default(path: Option<&Path>) -> Result<Tuning> {
    path.map_or_else(|| Ok(Tuning::default()), read)
}

fn read(path: &Path) -> Result<Tuning> {
    let text = read_text(path)?;
    parse(&text).map_err(|problem| {
        let error = Error::Key {
            path: path.to_owned(),
            problem,
        };
        kind::explained(error, path, &[Kind::Tuning])
    })
}

fn parse(text: &str) -> std::result::Result<Tuning, String> {
    let document: toml::Table =
        toml::from_str(text).map_err(|error| error.to_string().trim_end().to_owned())?;
    let mut tuning = Tuning::default();
    for (group, content) in &document {
        let keys = keys_of(group);
        if keys.is_empty() {
            let groups = groups().join(", ");
            return Err(format!(
                "[{group}]: unknown table; expected one of {groups}"
            ));
        }
        let toml::Value::Table(table) = content else {
            return Err(format!("{group}: expected a table, [{group}]"));
        };
        for (key, value) in table {
            let number = number(value)
                .ok_or_else(|| format!("{group}.{key} = {value}: expected a number"))?;
            tuning
                .set(group, key, number)
                .map_err(|error| match error {
                    TuningError::Unknown => {
                        let keys = keys.join(", ");
                        format!("{group}.{key}: unknown key; expected one of {keys}")
                    }
                    error => format!("{group}.{key} = {value}: {error}"),
                })?;
        }
    }
    Ok(tuning)
}

fn number(value: &toml::Value) -> Option<f64> {
    match value {
        toml::Value::Float(number) => Some(*number),
        toml::Value::Integer(number) => Some(*number as f64),
        _ => None,
    }
}

/// Returns the names of all groups, in order.
fn groups() -> Vec<&'static str> {
    let mut groups: Vec<&str> = Tuning::PARAMETERS
        .iter()
        .map(|parameter| parameter.group)
        .collect();
    groups.dedup();
    groups
}

/// Returns the keys of a group; empty if there is no such group.
fn keys_of(group: &str) -> Vec<&'static str> {
    Tuning::PARAMETERS
        .iter()
        .filter(|parameter| parameter.group == group)
        .map(|parameter| parameter.key)
        .collect()
}
