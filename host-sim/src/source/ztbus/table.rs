//! Rows as a signal table.

use super::mission::{Mission, MissionRow};
use super::split::Pass;
use crate::error::Result;
use crate::files::output::write_whole;
use crate::numeric::rounding::round;
use estimator_core::Signal;
use std::path::Path;

/// A column: its signal, its decimals, and its value in a row.
type TableColumn = (Signal, i32, fn(&MissionRow) -> Option<f64>);

const COLUMNS: [TableColumn; 11] = [
    (Signal::WheelSpeed, 4, |row| row.speed_mps),
    (Signal::TractionForce, 1, |row| row.traction_force_n),
    (Signal::BrakeSwitch, 0, |row| {
        row.braking.map(|on| f64::from(u8::from(on)))
    }),
    (Signal::BrakePressure, 0, |row| row.brake_pressure_pa),
    (Signal::Latitude, 7, |row| row.latitude_deg),
    (Signal::Longitude, 7, |row| row.longitude_deg),
    (Signal::Altitude, 2, |row| row.altitude_m),
    (Signal::Course, 2, |row| row.course_deg),
    (Signal::AmbientTemperature, 2, |row| row.ambient_celsius),
    (Signal::Mass, 0, |row| Some(row.mass_kg())),
    (Signal::Passengers, 0, |row| row.passengers),
];

impl Mission {
    /// Writes the whole mission as a signal table.
    ///
    /// # Errors
    /// Returns the error of the file system.
    pub fn write(&self, path: &Path) -> Result<()> {
        write(path, &self.rows)
    }

    /// Writes the rows of a pass as a signal table whose time starts at 0.
    ///
    /// # Errors
    /// Returns the error of the file system.
    pub fn write_pass(&self, path: &Path, pass: &Pass) -> Result<()> {
        write(path, &self.rows[pass.rows.clone()])
    }
}

/// Writes rows with the time since the first of them; missing values stay empty.
fn write(path: &Path, rows: &[MissionRow]) -> Result<()> {
    let start_s = rows.first().map_or(0.0, |row| row.time_s);
    write_whole(path, |out| {
        let mut writer = csv::Writer::from_writer(out);
        let names = COLUMNS.iter().map(|(signal, ..)| signal.column());
        writer.write_record(std::iter::once("time_s").chain(names))?;
        for row in rows {
            let time = text(row.time_s - start_s, 3);
            let values = COLUMNS.iter().map(|(_, decimals, value)| {
                value(row).map_or(String::new(), |v| text(v, *decimals))
            });
            writer.write_record(std::iter::once(time).chain(values))?;
        }
        writer.flush()
    })
}

fn text(value: f64, decimals: i32) -> String {
    // Adding zero turns minus zero into zero.
    (round(value, decimals) + 0.0).to_string()
}
