//! Errors on drives of other simulators and of measured vehicles, as committed.

use super::pipe_table::pipe_table;
use crate::accuracy::estimate::Estimate::{Lagged, Live, Smoothed};
use crate::accuracy::table::{AccuracyRow, committed};
use host_sim::error::Result;

const BY_ACCELEROMETER: &str = "its own accelerometer, over 300 m";

/// What is judged in a row, and by what; `None` for a drive of a simulator.
fn measured(drive: &str) -> Option<(&'static str, &'static str)> {
    Some(match drive {
        "ztbus-passes" => ("city bus, 19 t", "the map of its other passes, over 600 m"),
        "peterbilt-laps" => (
            "truck, 29.5 t, altitude once a lap",
            "the mean of eleven laps, over 300 m",
        ),
        "i3-median" => ("electric car, median of its trips", BY_ACCELEROMETER),
        "i3-nine-in-ten" => ("electric car, nine in ten of its trips", BY_ACCELEROMETER),
        _ => return None,
    })
}

/// Returns whether a row is of the measured car: the trip that is judged alone is one of all.
fn is_trip(row: &AccuracyRow) -> bool {
    row.drive.starts_with("i3-")
}

fn errors(row: &AccuracyRow) -> [String; 3] {
    [Smoothed, Lagged, Live].map(|estimate| format!("{:.3}", row.error_percent(estimate)))
}

/// Makes the table of measured vehicles.
pub fn of_vehicles() -> Result<Option<String>> {
    let committed = committed()?;
    let rows = committed.iter().filter_map(|row| {
        let (vehicle, judge) = measured(&row.drive)?;
        let [smoothed, lagged, live] = errors(row);
        Some([vehicle.to_owned(), judge.to_owned(), smoothed, lagged, live])
    });
    let header = [
        "measured",
        "judged by",
        "smoothed",
        "lagged by 500 m",
        "live",
    ];
    Ok(Some(pipe_table(header, rows)))
}

/// Makes the table of drives of other simulators, with the mean normalised squared errors.
pub fn of_simulators() -> Result<Option<String>> {
    let committed = committed()?;
    let is_drive = |row: &&AccuracyRow| measured(&row.drive).is_none() && !is_trip(row);
    let rows = committed.iter().filter(is_drive).map(|row| {
        let [smoothed, lagged, live] = errors(row);
        let nees = [Smoothed, Lagged, Live].map(|estimate| format!("{:.2}", row.nees(estimate)));
        let nees = nees.join(" / ");
        [row.drive.clone(), smoothed, lagged, live, nees]
    });
    let header = ["drive", "smoothed", "lagged by 500 m", "live", "NEES"];
    Ok(Some(pipe_table(header, rows)))
}
