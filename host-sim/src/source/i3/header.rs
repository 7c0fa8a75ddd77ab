//! The header of a trip's file: which column is where.

use crate::error::{Error, Result};
use crate::files::marks::BYTE_ORDER_MARK;
use csv::ByteRecord;
use std::path::Path;

/// What is read of a trip.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Quantity {
    Time,
    Velocity,
    Elevation,
    MotorTorque,
    Acceleration,
    Ambient,
}

/// A quantity: its column's name and unit, and what lacks without it.
struct Column {
    quantity: Quantity,
    name: &'static str,
    unit: &'static str,
    lacks: &'static str,
}

/// `Regenerative Braking Signal` is not among them: its torque is in the motor's torque.
const COLUMNS: [Column; 6] = [
    Column {
        quantity: Quantity::Time,
        name: "Time",
        unit: "s",
        lacks: "",
    },
    Column {
        quantity: Quantity::Velocity,
        name: "Velocity",
        unit: "km/h",
        lacks: "",
    },
    Column {
        quantity: Quantity::Elevation,
        name: "Elevation",
        unit: "m",
        lacks: "no altitude",
    },
    Column {
        quantity: Quantity::MotorTorque,
        name: "Motor Torque",
        unit: "Nm",
        lacks: "no force for the model",
    },
    Column {
        quantity: Quantity::Acceleration,
        name: "Longitudinal Acceleration",
        unit: "m/s^2",
        lacks: "no accelerometer",
    },
    Column {
        quantity: Quantity::Ambient,
        name: "Ambient Temperature",
        unit: "°C",
        lacks: "no ambient temperature",
    },
];

/// Where the columns of a file are.
#[derive(Clone, Debug)]
pub(super) struct Places {
    places: [Option<usize>; COLUMNS.len()],
}

impl Places {
    /// Finds the columns in a header.
    ///
    /// # Errors
    /// Returns an error for a header without time or velocity, with a column twice, or in another
    /// unit.
    pub(super) fn find(path: &Path, header: &ByteRecord) -> Result<Self> {
        let mut places = [None; COLUMNS.len()];
        for (index, field) in header.iter().enumerate() {
            let (name, unit) = name_and_unit(field);
            let Some(at) = COLUMNS.iter().position(|column| column.name == name) else {
                continue;
            };
            if unit != COLUMNS[at].unit {
                let problem = format!("{name} is in `{unit}`");
                return Err(Error::line(path, 1, problem, expected_column(at)));
            }
            if places[at].replace(index).is_some() {
                let problem = format!("column `{name}` is repeated");
                return Err(Error::line(path, 1, problem, "each column once"));
            }
        }
        for at in [Quantity::Time, Quantity::Velocity].map(|quantity| quantity as usize) {
            if places[at].is_none() {
                let problem = format!("no column `{}`", COLUMNS[at].name);
                let expected = format!("a trip of the i3 with {}", expected_column(at));
                return Err(Error::line(path, 1, problem, expected));
            }
        }
        Ok(Self { places })
    }

    /// Returns the index of a column; `None` if the file does not have it.
    pub(super) fn of(&self, quantity: Quantity) -> Option<usize> {
        self.places[quantity as usize]
    }

    /// Returns the columns that are missing, and what lacks without each.
    pub(super) fn missing(&self) -> impl Iterator<Item = String> {
        COLUMNS
            .iter()
            .filter(|column| self.of(column.quantity).is_none())
            .map(|column| format!("no column `{}`: {}", column.name, column.lacks))
    }
}

/// Returns the name of a quantity's column, for messages.
pub(super) fn name_of(quantity: Quantity) -> &'static str {
    COLUMNS[quantity as usize].name
}

fn expected_column(at: usize) -> String {
    format!("`{} [{}]`", COLUMNS[at].name, COLUMNS[at].unit)
}

/// Splits `Name [unit]`, in Latin-1 or UTF-8.
fn name_and_unit(field: &[u8]) -> (String, String) {
    let field = field.strip_prefix(BYTE_ORDER_MARK).unwrap_or(field);
    let text = match str::from_utf8(field) {
        Ok(text) => text.to_owned(),
        Err(_) => field.iter().map(|byte| char::from(*byte)).collect(),
    };
    let (name, unit) = text.split_once('[').unwrap_or((&text, ""));
    // Some headers close a bracket twice, or with another one.
    let is_bracket = |c: char| matches!(c, ']' | ')' | ' ');
    let unit = unit.trim().trim_end_matches(is_bracket);
    (name.trim().to_owned(), unit.to_owned())
}
