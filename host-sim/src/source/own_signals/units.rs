//! Units that `.dbc` files and other logs write, and those of our signals.

use super::mapping_file::{MappingEntry, MappingFile};
use crate::error::Result;
use crate::source::signal_range::unit_of_column;
use estimator_core::Signal;

/// How a unit becomes the one that the name of a column ends in: plain names of the unit, ending of
/// the column, scale, offset. Long names without blanks are those of VW's files (`Unit_NewtoMeter`).
const CONVERSIONS: [(&[&str], &str, f64, f64); 33] = [
    (&["m/s", "mps", "meterpersecon"], "_mps", 1.0, 0.0),
    (
        &[
            "km/h",
            "kph",
            "kmh",
            "kmph",
            "km_h",
            "km/hour",
            "km/hr",
            "k.p.h.",
            "kilometerperhour",
        ],
        "_mps",
        1.0 / 3.6,
        0.0,
    ),
    (&["mph", "mi/h", "miles/h", "mile/h"], "_mps", 0.447_04, 0.0),
    (
        &["kn", "kt", "kts", "knot", "knots"],
        "_mps",
        1_852.0 / 3_600.0,
        0.0,
    ),
    (&["cm/s"], "_mps", 0.01, 0.0),
    (&["%", "percent", "pct", "prozent"], "_percent", 1.0, 0.0),
    (
        &[
            "rpm",
            "1/min",
            "u/min",
            "min-1",
            "min^-1",
            "r/min",
            "rev/min",
            "minutinver",
        ],
        "_rpm",
        1.0,
        0.0,
    ),
    (&["pa"], "_pa", 1.0, 0.0),
    (&["hpa", "mbar", "millibar"], "_pa", 100.0, 0.0),
    (&["kpa"], "_pa", 1e3, 0.0),
    (&["bar"], "_pa", 1e5, 0.0),
    (&["psi"], "_pa", 6_894.757, 0.0),
    (&["n", "newto"], "_n", 1.0, 0.0),
    (&["kn"], "_n", 1e3, 0.0),
    (
        &["nm", "n*m", "n.m", "n-m", "n·m", "newtometer"],
        "_nm",
        1.0,
        0.0,
    ),
    (
        &[
            "lbft", "lb-ft", "lb*ft", "ft-lb", "ftlb", "lbf-ft", "lbf*ft",
        ],
        "_nm",
        1.355_818,
        0.0,
    ),
    (&["kg", "kilog"], "_kg", 1.0, 0.0),
    (&["t", "ton", "tons", "tonne", "tonnes"], "_kg", 1e3, 0.0),
    (&["lb", "lbs"], "_kg", 0.453_592_37, 0.0),
    (&["m", "meter", "meters", "metre", "metres"], "_m", 1.0, 0.0),
    (&["ft", "feet"], "_m", 0.3048, 0.0),
    (
        &["deg", "°", "degree", "degrees", "degreofarc"],
        "_deg",
        1.0,
        0.0,
    ),
    (&["rad"], "_deg", 180.0 / std::f64::consts::PI, 0.0),
    (&["rad/s"], "_radps", 1.0, 0.0),
    (
        &["deg/s", "°/s", "degree/s", "degreofarcpersecon"],
        "_radps",
        std::f64::consts::PI / 180.0,
        0.0,
    ),
    (
        &["°c", "c", "degc", "celsius", "degrecelsi"],
        "_celsius",
        1.0,
        0.0,
    ),
    (&["k", "degk", "kelvin"], "_celsius", 1.0, -273.15),
    (
        &["°f", "f", "degf", "fahrenheit"],
        "_celsius",
        5.0 / 9.0,
        -160.0 / 9.0,
    ),
    (
        &[
            "m/s2",
            "m/s^2",
            "m/s²",
            "m/s/s",
            "m/sec2",
            "mps2",
            "meterperseconsquar",
        ],
        "_mps2",
        1.0,
        0.0,
    ),
    (&["g"], "_mps2", 9.806_65, 0.0),
    (&["mg"], "_mps2", 9.806_65e-3, 0.0),
    (
        &["kgm2", "kg*m2", "kg*m^2", "kgm²", "kgm^2"],
        "_kgm2",
        1.0,
        0.0,
    ),
    (&["mm"], "_m", 1e-3, 0.0),
];

/// What stands in the place of a unit where there is none.
const NO_UNIT: [&str; 5] = ["", "-", "none", "unitless", "n/a"];

/// Returns a unit in lower case, without blanks, brackets, and VW's `Unit_`.
fn plain(unit: &str) -> String {
    let unit = unit.trim().to_lowercase().replace(' ', "");
    let brackets = [('[', ']'), ('(', ')')];
    let inside = brackets
        .iter()
        .find_map(|(open, close)| unit.strip_prefix(*open)?.strip_suffix(*close));
    let unit = inside.unwrap_or(&unit);
    unit.strip_prefix("unit_").unwrap_or(unit).to_owned()
}

/// Returns scale and offset from a unit to that of a signal; `None` if it is not known.
#[must_use]
pub fn conversion(unit: &str, signal: Signal) -> Option<(f64, f64)> {
    let unit = plain(unit);
    let column = signal.column();
    let found = CONVERSIONS
        .iter()
        .find(|(names, ending, ..)| column.ends_with(ending) && names.contains(&&*unit));
    found.map(|(_, _, scale, offset)| (*scale, *offset))
}

/// Returns whether a unit is known.
#[must_use]
pub fn is_known(unit: &str) -> bool {
    let unit = plain(unit);
    let mut all = CONVERSIONS.iter();
    all.any(|(names, ..)| names.contains(&&*unit))
}

/// Returns whether a text says that there is no unit.
#[must_use]
pub fn is_none(unit: &str) -> bool {
    NO_UNIT.contains(&&*plain(unit))
}

/// Returns whether a unit is named that does not become that of a signal: it is not known, or of
/// another quantity.
pub(in crate::source) fn is_doubtful(unit: &str, signal: Signal) -> bool {
    !unit_of_column(signal).is_empty() && !is_none(unit) && conversion(unit, signal).is_none()
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
/// Returns an error for a unit that is not known, or of another quantity.
pub(in crate::source) fn conversion_of(
    file: &MappingFile,
    entry: &MappingEntry,
    name: &str,
    unit: &str,
) -> Result<(f64, f64)> {
    if entry.scale.is_some() || entry.offset.is_some() {
        return Ok((entry.scale.unwrap_or(1.0), entry.offset.unwrap_or(0.0)));
    }
    if is_doubtful(unit, entry.signal) {
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
