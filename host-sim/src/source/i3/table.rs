//! Rows as a signal table.

use super::trip::{Trip, TripRow};
use super::vehicle::MASS_KG;
use crate::error::Result;
use crate::numeric::rounding::round;
use crate::source::signal_table;
use estimator_core::{Instant, Signal};
use std::path::Path;

/// A column: its signal, its decimals, and its value in a row.
type TableColumn = (Signal, i32, fn(&TripRow) -> Option<f64>);

const COLUMNS: [TableColumn; 6] = [
    (Signal::WheelSpeed, 5, |row| row.speed_mps),
    (Signal::MotorTorque, 2, |row| row.motor_torque_nm),
    (Signal::LongitudinalAcceleration, 2, |row| {
        row.acceleration_mps2
    }),
    (Signal::Altitude, 2, |row| row.altitude_m),
    (Signal::AmbientTemperature, 2, |row| row.ambient_celsius),
    // Nobody boards on the way. Without it, each wait at a light might be for another load.
    (Signal::Mass, 0, |_| Some(MASS_KG)),
];

impl Trip {
    /// Writes the trip as a signal table with the columns that it has; missing values stay empty.
    ///
    /// # Errors
    /// Returns the error of the file system.
    pub fn write(&self, path: &Path) -> Result<()> {
        let has = |column: &&TableColumn| self.rows.iter().any(|row| column.2(row).is_some());
        let columns: Vec<&TableColumn> = COLUMNS.iter().filter(has).collect();
        let signals: Vec<Signal> = columns.iter().map(|(signal, ..)| *signal).collect();
        let rows = self.rows.iter().map(|row| {
            let values = columns.iter().map(|(_, decimals, value)| {
                // Adding zero turns minus zero into zero.
                value(row).map(|value| round(value, *decimals) + 0.0)
            });
            let micros = (row.time_s * 1e6).round() as u64;
            (Instant::from_micros(micros), values.collect::<Vec<_>>())
        });
        signal_table::write(path, &signals, rows)
    }
}
