//! Checks of CSV rows, so that an error names its line.

/// A problem of a row.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Flaw {
    /// The problem.
    pub problem: String,
    /// The expected value.
    pub expected: &'static str,
}

/// Checks that every number is finite.
///
/// # Errors
/// Returns an error that names the first number that is not finite.
pub fn finite(values: &[(&str, f64)]) -> Result<(), Flaw> {
    match values.iter().find(|(_, value)| !value.is_finite()) {
        None => Ok(()),
        Some((name, value)) => Err(Flaw {
            problem: format!("{name} is {value}"),
            expected: "a finite number",
        }),
    }
}

/// Checks that every number is greater than zero. A standard deviation of zero would have infinite
/// weight.
///
/// # Errors
/// Returns an error that names the first number that is not positive.
pub fn positive(values: &[(&str, f64)]) -> Result<(), Flaw> {
    match values.iter().find(|(_, value)| *value <= 0.0) {
        None => Ok(()),
        Some((name, value)) => Err(Flaw {
            problem: format!("{name} is {value}"),
            expected: "a number greater than zero",
        }),
    }
}

/// Checks a position on Earth, degrees.
///
/// # Errors
/// Returns an error that names the angle that is out of range.
pub fn position(latitude_deg: f64, longitude_deg: f64) -> Result<(), Flaw> {
    let on_earth = |name, value: f64, limit: f64, expected| {
        if value.abs() <= limit {
            Ok(())
        } else {
            Err(Flaw {
                problem: format!("{name} is {value}"),
                expected,
            })
        }
    };
    on_earth(
        "latitude_deg",
        latitude_deg,
        90.0,
        "degrees within -90 and 90",
    )?;
    on_earth(
        "longitude_deg",
        longitude_deg,
        180.0,
        "degrees within -180 and 180",
    )
}

/// Checks that a quantity grows from row to row; if `strictly`, it may not stay equal.
///
/// # Errors
/// Returns an error that names the quantity.
pub fn forwards(name: &str, before: f64, now: f64, strictly: bool) -> Result<(), Flaw> {
    if now > before || (now == before && !strictly) {
        return Ok(());
    }
    Err(Flaw {
        problem: format!("{name} is {now} after {before}"),
        expected: "a number that grows from row to row",
    })
}
