//! Units of our signals, and the ranges that vehicles reach.

use estimator_core::Signal;

/// Endings of columns, the units that they mean, and the ranges that vehicles reach.
const UNITS: [(&str, &str, f64, f64); 15] = [
    ("_percent", "%", -125.0, 125.0),
    ("_rpm", "rpm", 0.0, 8_000.0),
    ("_mps", "m/s", 0.0, 70.0),
    ("_mps2", "m/s²", -20.0, 20.0),
    ("_pa", "Pa", 0.0, 2e6),
    ("_kgm2", "kg m²", 0.0, 50.0),
    ("_kg", "kg", 500.0, 200_000.0),
    ("_nm", "Nm", -50_000.0, 50_000.0),
    ("_n", "N", -200_000.0, 200_000.0),
    ("_m", "m", -1_000.0, 10_000.0),
    ("_deg", "deg", -180.0, 360.0),
    ("_radps", "rad/s", -2.0, 2.0),
    ("_celsius", "°C", -60.0, 60.0),
    ("_s", "s", 0.0, 4e9),
    ("_kw", "kW", -1_000.0, 1_000.0),
];

/// Returns the unit of a signal's column; empty for counts, ratios and switches.
#[must_use]
pub fn unit(signal: Signal) -> &'static str {
    of_column(signal.column()).map_or("", |(_, unit, ..)| *unit)
}

/// Returns the ending of a signal's column that means its unit; empty as for [`unit()`].
#[must_use]
pub fn unit_of_column(signal: Signal) -> &'static str {
    of_column(signal.column()).map_or("", |(ending, ..)| *ending)
}

/// Returns the least and the greatest value that a vehicle reaches, in the unit of the column. The
/// core does not use speeds, positions, pressures and temperatures beyond it.
#[must_use]
pub fn plausible_range(signal: Signal) -> (f64, f64) {
    match signal {
        Signal::Latitude => (-90.0, 90.0),
        Signal::Longitude => (-180.0, 180.0),
        Signal::Course => (0.0, 360.0),
        Signal::VerticalSpeed => (-30.0, 30.0),
        Signal::Pitch => (-45.0, 45.0),
        Signal::MotorSpeed => (-20_000.0, 20_000.0),
        Signal::RetarderForce => (-100_000.0, 100_000.0),
        Signal::AirPressure => (50_000.0, 110_000.0),
        Signal::CurrentGear | Signal::SelectedGear => (-10.0, 30.0),
        Signal::GearRatio => (-30.0, 30.0),
        Signal::FixMethod | Signal::EngineTorqueMode => (0.0, 15.0),
        Signal::Satellites => (0.0, 64.0),
        Signal::Hdop | Signal::Vdop => (0.0, 100.0),
        Signal::Passengers => (0.0, 300.0),
        Signal::Fan | Signal::BrakePedal | Signal::ClutchSlip => (0.0, 100.0),
        _ => match of_column(signal.column()) {
            Some((_, _, least, most)) => (*least, *most),
            None => (0.0, 1.0),
        },
    }
}

fn of_column(column: &str) -> Option<&'static (&'static str, &'static str, f64, f64)> {
    UNITS.iter().find(|(ending, ..)| column.ends_with(ending))
}
