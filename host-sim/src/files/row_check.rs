//! Checks on the rows of the CSV files, so that a wrong number is told with its line.

/// What is wrong with a row: what was found, and what would do.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Flaw {
    pub problem: String,
    pub expected: &'static str,
}

/// Every number is finite.
///
/// # Errors
/// Names the first that is not.
pub fn finite(values: &[(&str, f64)]) -> Result<(), Flaw> {
    match values.iter().find(|(_, value)| !value.is_finite()) {
        None => Ok(()),
        Some((name, value)) => Err(Flaw {
            problem: format!("{name} is {value}"),
            expected: "a finite number",
        }),
    }
}

/// Every number is greater than zero (a standard deviation of zero would outweigh every other).
///
/// # Errors
/// Names the first that is not.
pub fn positive(values: &[(&str, f64)]) -> Result<(), Flaw> {
    match values.iter().find(|(_, value)| *value <= 0.0) {
        None => Ok(()),
        Some((name, value)) => Err(Flaw {
            problem: format!("{name} is {value}"),
            expected: "a number greater than zero",
        }),
    }
}

/// A position on Earth.
///
/// # Errors
/// Names the angle out of range.
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

/// A quantity grows from row to row; `strictly` if it may not stand either.
///
/// # Errors
/// Names the quantity.
pub fn forwards(name: &str, before: f64, now: f64, strictly: bool) -> Result<(), Flaw> {
    if now > before || (now == before && !strictly) {
        return Ok(());
    }
    Err(Flaw {
        problem: format!("{name} is {now} after {before}"),
        expected: "a number that grows from row to row",
    })
}
