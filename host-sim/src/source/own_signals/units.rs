//! Units that `.dbc` files and other logs write, and those of our signals.

use super::mapping_file::{MappingEntry, MappingFile};
use crate::error::Result;
use estimator_core::Signal;

/// How a unit becomes the one that the name of a column ends in: names of the unit in lower case
/// without blanks, ending of the column, scale, offset.
const CONVERSIONS: [(&[&str], &str, f64, f64); 26] = [
    (&["m/s", "mps"], "_mps", 1.0, 0.0),
    (&["km/h", "kph", "kmh", "km/hour"], "_mps", 1.0 / 3.6, 0.0),
    (&["mph", "mi/h"], "_mps", 0.447_04, 0.0),
    (&["%", "percent"], "_percent", 1.0, 0.0),
    (
        &["rpm", "1/min", "u/min", "min-1", "r/min"],
        "_rpm",
        1.0,
        0.0,
    ),
    (&["pa"], "_pa", 1.0, 0.0),
    (&["hpa", "mbar"], "_pa", 100.0, 0.0),
    (&["kpa"], "_pa", 1e3, 0.0),
    (&["bar"], "_pa", 1e5, 0.0),
    (&["n"], "_n", 1.0, 0.0),
    (&["kn"], "_n", 1e3, 0.0),
    (&["nm", "n*m", "n·m"], "_nm", 1.0, 0.0),
    (&["kg"], "_kg", 1.0, 0.0),
    (&["t"], "_kg", 1e3, 0.0),
    (&["m"], "_m", 1.0, 0.0),
    (&["ft"], "_m", 0.3048, 0.0),
    (&["deg", "°", "degree", "degrees"], "_deg", 1.0, 0.0),
    (&["rad"], "_deg", 180.0 / std::f64::consts::PI, 0.0),
    (&["rad/s"], "_radps", 1.0, 0.0),
    (
        &["deg/s", "°/s", "degree/s"],
        "_radps",
        std::f64::consts::PI / 180.0,
        0.0,
    ),
    (&["°c", "c", "degc"], "_celsius", 1.0, 0.0),
    (&["k", "degk"], "_celsius", 1.0, -273.15),
    (&["°f", "f", "degf"], "_celsius", 5.0 / 9.0, -160.0 / 9.0),
    (&["m/s2", "m/s^2", "m/s²", "mps2"], "_mps2", 1.0, 0.0),
    (&["g"], "_mps2", 9.806_65, 0.0),
    (&["kgm2", "kg*m^2", "kgm²", "kgm^2"], "_kgm2", 1.0, 0.0),
];

/// Returns scale and offset from a unit to that of a signal; `None` if it is not known.
#[must_use]
pub fn conversion(unit: &str, signal: Signal) -> Option<(f64, f64)> {
    let unit = unit.trim().to_lowercase().replace(' ', "");
    let column = signal.column();
    let found = CONVERSIONS
        .iter()
        .find(|(names, ending, ..)| column.ends_with(ending) && names.contains(&&*unit));
    found.map(|(_, _, scale, offset)| (*scale, *offset))
}

/// Returns whether a unit is known.
#[must_use]
pub fn is_known(unit: &str) -> bool {
    let unit = unit.trim().to_lowercase().replace(' ', "");
    let mut all = CONVERSIONS.iter();
    all.any(|(names, ..)| names.contains(&&*unit))
}

/// Returns whether a unit is one of another quantity than the signal's.
#[must_use]
pub fn contradicts(unit: &str, signal: Signal) -> bool {
    is_known(unit) && conversion(unit, signal).is_none()
}

/// Returns scale and offset from the unit of the signal that an entry names to ours: those of the
/// entry, else those that the units ask for.
///
/// # Errors
/// Returns an error for a unit of another quantity.
pub(in crate::source) fn conversion_of(
    file: &MappingFile,
    entry: &MappingEntry,
    name: &str,
    unit: &str,
) -> Result<(f64, f64)> {
    if entry.scale.is_some() || entry.offset.is_some() {
        return Ok((entry.scale.unwrap_or(1.0), entry.offset.unwrap_or(0.0)));
    }
    if contradicts(unit, entry.signal) {
        let problem = format!(
            "signals.{} has no scale, and its signal `{name}` is in `{}`",
            entry.signal.column(),
            unit.escape_debug()
        );
        let expected = "scale, and offset if there is one, to the unit in the name of ours";
        return Err(file.error(entry.source.line, problem, expected));
    }
    Ok(conversion(unit, entry.signal).unwrap_or((1.0, 0.0)))
}
