//! Colours of values on a plan.

use super::colour::{self, RGBColor, for_both_themes};
use crate::numeric::statistics::quantile;
use serde_json::{Value, json};

/// Colours for one of the values. A value has the colour of the first class whose upper limit is
/// above it.
#[derive(Clone, Debug)]
pub struct Colouring {
    /// What the value is, e.g. "grade".
    pub name: String,
    /// Its unit.
    pub unit: &'static str,
    /// Upper limits of all classes but the last.
    pub limits: Vec<f64>,
    /// Colours of the classes, one more than limits.
    pub colours: Vec<RGBColor>,
}

impl Colouring {
    /// Creates the colours of grades, %, with steps that suit these.
    pub fn grades(grades_percent: impl IntoIterator<Item = f64>) -> Self {
        let sizes = grades_percent.into_iter().map(f64::abs);
        // The outermost limits are 2.5 steps from level.
        let step = nice_above(quantile(sizes, 0.9) / 2.5);
        Self {
            name: "grade".to_owned(),
            unit: "%",
            limits: [-2.5, -1.5, -0.5, 0.5, 1.5, 2.5]
                .map(|n| tidy(n * step))
                .to_vec(),
            colours: colour::GRADES.to_vec(),
        }
    }

    /// Creates the colours of amounts that are not negative, with limits that suit these.
    pub fn amounts(
        name: impl Into<String>,
        unit: &'static str,
        amounts: impl IntoIterator<Item = f64>,
    ) -> Self {
        let amounts: Vec<f64> = amounts.into_iter().collect();
        let limit = |part| nice_above(quantile(amounts.iter().copied(), part));
        let mut limits = [0.25, 0.5, 0.9].map(limit).to_vec();
        limits.dedup();
        Self {
            name: name.into(),
            unit,
            colours: colour::AMOUNTS[..=limits.len()].to_vec(),
            limits,
        }
    }

    pub(super) fn json(&self) -> Value {
        let names = (0..self.colours.len()).map(|class| self.class_name(class));
        let colours = self.colours.iter().map(|colour| for_both_themes(*colour));
        json!({
            "name": self.name,
            "unit": self.unit,
            "limits": self.limits,
            "colours": colours.collect::<Vec<_>>(),
            "classes": names.collect::<Vec<_>>(),
        })
    }

    fn class_name(&self, class: usize) -> String {
        let unit = self.unit;
        match (class.checked_sub(1), self.limits.get(class)) {
            (None, None) => "all".to_owned(),
            (None, Some(limit)) => format!("below {limit} {unit}"),
            (Some(before), None) => format!("above {} {unit}", self.limits[before]),
            (Some(before), Some(limit)) => format!("{} to {limit}", self.limits[before]),
        }
    }
}

/// Returns the smallest of 1, 1.5, 2, 3, 5, 7 times a power of ten that is at least `value`.
fn nice_above(value: f64) -> f64 {
    let value = value.max(1e-3);
    let power = 10_f64.powi(value.log10().floor() as i32);
    let nice = [1.0, 1.5, 2.0, 3.0, 5.0, 7.0].map(|n| n * power);
    let found = nice.into_iter().find(|nice| *nice >= value * (1.0 - 1e-9));
    tidy(found.unwrap_or(10.0 * power))
}

/// Rounds off the error of binary fractions.
fn tidy(value: f64) -> f64 {
    (value * 1e6).round() / 1e6
}
