//! The value of a cell, and what it may be.

use estimator_core::{Signal, Value};

/// Returns the value of a number, `None` for a text that is none.
///
/// # Errors
/// Returns what was expected.
pub(in super::super) fn checked(
    signal: Signal,
    number: Option<f64>,
) -> Result<Value, &'static str> {
    if let Some(most) = largest_angle_deg(signal) {
        return number
            .filter(|degrees| degrees.abs() <= most)
            .map(|degrees| Value::DegreesE7((degrees * 1e7).round() as i32))
            .ok_or("degrees within the globe, or an empty cell");
    }
    let number = number.ok_or("a finite number, or an empty cell")?;
    let (most, expected) = range_of(signal);
    if number.abs() <= most {
        Ok(Value::Real(number as f32))
    } else {
        Err(expected)
    }
}

/// Cells that mean that there is no value, in lower case.
const MISSING: [&[u8]; 9] = [
    b"", b"nan", b"na", b"n/a", b"#n/a", b"null", b"none", b"-", b"--",
];

/// Returns true for a cell without a value.
pub(in super::super) fn is_missing(cell: &[u8]) -> bool {
    // Most cells are longer numbers.
    cell.len() <= 4 && MISSING.iter().any(|text| cell.eq_ignore_ascii_case(text))
}

/// Returns the number of a word for on or off.
pub(in super::super) fn switch(cell: &[u8]) -> Option<f64> {
    let is = |word: &[u8]| cell.eq_ignore_ascii_case(word);
    if is(b"true") {
        Some(1.0)
    } else {
        is(b"false").then_some(0.0)
    }
}

/// Returns the largest value of an angle. Angles have more digits than `f32`.
pub(super) const fn largest_angle_deg(signal: Signal) -> Option<f64> {
    match signal {
        Signal::Latitude => Some(90.0),
        Signal::Longitude => Some(180.0),
        _ => None,
    }
}

/// Magnitudes that no reading exceeds, by the unit in which the name of a column ends. The core
/// treats readings beyond narrower ranges as not available; these detect another unit, another
/// column, or a damaged digit.
const LARGEST: [(&str, f64, &str); 12] = [
    (
        "_percent",
        1e4,
        "a finite number from -1e4 to 1e4 %, or an empty cell",
    ),
    (
        "_rpm",
        1e6,
        "a finite number from -1e6 to 1e6 rpm, or an empty cell",
    ),
    (
        "_mps",
        1e4,
        "a finite number from -1e4 to 1e4 m/s, or an empty cell",
    ),
    (
        "_mps2",
        1e4,
        "a finite number from -1e4 to 1e4 m/s², or an empty cell",
    ),
    (
        "_nm",
        1e6,
        "a finite number from -1e6 to 1e6 Nm, or an empty cell",
    ),
    (
        "_pa",
        1e9,
        "a finite number from -1e9 to 1e9 Pa, or an empty cell",
    ),
    (
        "_kg",
        1e7,
        "a finite number from -1e7 to 1e7 kg, or an empty cell",
    ),
    (
        "_n",
        1e8,
        "a finite number from -1e8 to 1e8 N, or an empty cell",
    ),
    (
        "_m",
        1e5,
        "a finite number from -1e5 to 1e5 m, or an empty cell",
    ),
    (
        "_deg",
        1e4,
        "a finite number from -1e4 to 1e4 degrees, or an empty cell",
    ),
    (
        "_radps",
        1e4,
        "a finite number from -1e4 to 1e4 rad/s, or an empty cell",
    ),
    (
        "_celsius",
        1e4,
        "a finite number from -1e4 to 1e4 degrees, or an empty cell",
    ),
];
/// The same for columns without a unit: counts, ratios and switches.
const LARGEST_OTHER: (f64, &str) = (1e6, "a finite number from -1e6 to 1e6, or an empty cell");

fn range_of(signal: Signal) -> (f64, &'static str) {
    let column = signal.column();
    let unit = LARGEST.iter().find(|(unit, ..)| column.ends_with(unit));
    unit.map_or(LARGEST_OTHER, |(_, most, expected)| (*most, *expected))
}
