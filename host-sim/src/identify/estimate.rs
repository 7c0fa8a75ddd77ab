//! A value with its standard deviation, and what stands for one that is not known.

use serde::{Deserialize, Serialize};

/// A value with its standard deviation.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Estimate {
    /// The value.
    pub value: f64,
    /// One standard deviation, in the unit of the value.
    pub sigma: f64,
}

impl Estimate {
    /// Returns this value with this sigma.
    #[must_use]
    pub const fn new(value: f64, sigma: f64) -> Self {
        Self { value, sigma }
    }

    /// Returns the sigma as a part of the value.
    #[must_use]
    pub fn relative_sigma(&self) -> f64 {
        self.sigma / self.value
    }
}

/// What logs leave unknown, and the drive that would show it.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Unknown {
    /// What is not known.
    pub what: String,
    /// What to record.
    pub advice: String,
}

/// Returns a number with two significant digits, without an exponent.
pub(super) fn two_digits(value: f64) -> String {
    if value <= 0.0 || !value.is_finite() {
        return "0".to_owned();
    }
    let decimals = (1 - value.log10().floor() as i32).max(0);
    format!("{value:.*}", decimals as usize)
}
