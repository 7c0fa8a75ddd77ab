//! Ranges of parameters, and the error that names a parameter outside its range.

use core::fmt;

/// A parameter that no vehicle can have.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct ParameterError {
    /// Name of the effect to which the parameter belongs; `None` for a parameter of the vehicle.
    pub effect: Option<&'static str>,
    /// Key in the vehicle file.
    pub key: &'static str,
    /// The value found.
    pub value: f32,
    /// What is expected, with its unit.
    pub expected: &'static str,
}

impl fmt::Display for ParameterError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if let Some(effect) = self.effect {
            write!(f, "effects.{effect}.")?;
        }
        write!(
            f,
            "{} = {}: expected {}",
            self.key, self.value, self.expected
        )
    }
}

impl core::error::Error for ParameterError {}

impl ParameterError {
    /// Returns the same error as one of an effect's parameter.
    pub(crate) const fn of_effect(self, name: &'static str) -> Self {
        Self {
            effect: Some(name),
            ..self
        }
    }
}

/// The range of a parameter.
pub(crate) struct Limits {
    /// Key in the vehicle file.
    pub key: &'static str,
    /// Smallest value.
    pub low: f32,
    /// Largest value.
    pub high: f32,
    /// What is expected, with its unit.
    pub expected: &'static str,
}

impl Limits {
    pub(crate) const fn new(
        key: &'static str,
        low: f32,
        high: f32,
        expected: &'static str,
    ) -> Self {
        Self {
            key,
            low,
            high,
            expected,
        }
    }
}

/// Checks values, each by its limits.
///
/// # Errors
/// The first parameter that is not finite or beyond its limits.
#[inline(never)] // Only for a vehicle's creation.
pub(crate) fn check_all(limits: &[Limits], values: &[f32]) -> Result<(), ParameterError> {
    for (of, value) in limits.iter().zip(values) {
        check(of.key, *value, of.low, of.high, of.expected)?;
    }
    Ok(())
}

/// Checks that a value is finite and from `low` to `high`.
///
/// # Errors
/// The parameter with its value and what is expected, if it is not.
#[inline(never)] // Only for a vehicle's creation.
pub(crate) fn check(
    key: &'static str,
    value: f32,
    low: f32,
    high: f32,
    expected: &'static str,
) -> Result<(), ParameterError> {
    if value.is_finite() && value >= low && value <= high {
        Ok(())
    } else {
        Err(ParameterError {
            effect: None,
            key,
            value,
            expected,
        })
    }
}
