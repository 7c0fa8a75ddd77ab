//! Range checks of the keys of a scenario.

use super::range_check::check;
use super::road_generator::RoadShape;
use super::scenario_file::ScenarioDocument;
use std::ops::RangeInclusive;

/// Air temperatures that a truck drives in, °C.
pub const TEMPERATURES_CELSIUS: RangeInclusive<f64> = -60.0..=60.0;

/// Checks the document, but not the files that it names.
///
/// # Errors
/// Returns the problem, beginning with the name of the key.
pub fn check_document(document: &ScenarioDocument) -> Result<(), String> {
    if document.runs.is_empty() {
        return Err("runs: no runs; expected at least one [[runs]]".to_owned());
    }
    let ScenarioDocument {
        noise,
        accelerometer,
        pitch,
        gnss,
        latency_ms,
        rates,
        air,
        wind,
        tyres,
        planted,
        ..
    } = document;
    planted.check()?;
    accelerometer.map_or(Ok(()), |table| table.check())?;
    pitch.map_or(Ok(()), |table| table.check())?;
    check_steady_wind(wind.speed_mps, wind.from_deg)?;
    check("wind.gust_sigma_mps", wind.gust_sigma_mps, 0.0..=20.0)?;
    check("wind.gust_time_s", wind.gust_time_s, 0.1..=1e6)?;
    check("tyres.cold_amount", tyres.cold_amount, 0.0..=5.0)?;
    check("tyres.cold_time_s", tyres.cold_time_s, 1.0..=1e6)?;
    check("noise.speed_sigma_mps", noise.speed_sigma_mps, 0.0..=5.0)?;
    check(
        "noise.yaw_rate_sigma_radps",
        noise.yaw_rate_sigma_radps,
        0.0..=1.0,
    )?;
    check("gnss.altitude_sigma_m", gnss.altitude_sigma_m, 0.0..=100.0)?;
    check("gnss.altitude_time_s", gnss.altitude_time_s, 0.1..=1e6)?;
    check(
        "gnss.altitude_white_sigma_m",
        gnss.altitude_white_sigma_m,
        0.0..=100.0,
    )?;
    check("gnss.position_sigma_m", gnss.position_sigma_m, 0.0..=1000.0)?;
    check("gnss.position_time_s", gnss.position_time_s, 0.1..=1e6)?;
    check("gnss.speed_sigma_mps", gnss.speed_sigma_mps, 0.0..=10.0)?;
    check("gnss.course_sigma_deg", gnss.course_sigma_deg, 0.0..=180.0)?;
    for (name, faults) in [("gnss.steps", &gnss.steps), ("gnss.ramps", &gnss.ramps)] {
        for &(from_m, to_m, metres) in faults {
            check(&format!("{name} (start)"), from_m, 0.0..=1e9)?;
            check(&format!("{name} (end)"), to_m, from_m..=1e9)?;
            check(&format!("{name} (metres)"), metres, -1e4..=1e4)?;
        }
    }
    for outage in &gnss.outages_m {
        check("gnss.outages_m (start)", outage.0, 0.0..=1e9)?;
        check("gnss.outages_m (end)", outage.1, outage.0..=1e9)?;
    }
    for (name, value) in [
        ("torque", latency_ms.torque),
        ("speed", latency_ms.speed),
        ("gearbox", latency_ms.gearbox),
        ("chassis", latency_ms.chassis),
        ("gnss", latency_ms.gnss),
    ] {
        check(&format!("latency_ms.{name}"), value, 0.0..=5_000.0)?;
    }
    check("rates.fast_ms", rates.fast_ms, 10.0..=1_000.0)?;
    check("air.pressure_pa", air.pressure_pa, 50_000.0..=110_000.0)?;
    check(
        "air.temperature_celsius",
        air.temperature_celsius,
        TEMPERATURES_CELSIUS,
    )
}

/// Checks the steady part of the wind.
///
/// # Errors
/// Returns the problem, beginning with the name of the key.
pub fn check_steady_wind(speed_mps: f64, from_deg: f64) -> Result<(), String> {
    check("wind.speed_mps", speed_mps, 0.0..=40.0)?;
    check("wind.from_deg", from_deg, 0.0..=360.0)
}

/// Checks the shape of a generated road.
///
/// # Errors
/// Returns the problem, beginning with the name of the key.
pub fn check_shape(shape: &RoadShape) -> Result<(), String> {
    check("road.length_m", shape.length_m, 100.0..=1e6)?;
    check(
        "road.grade_sigma_percent",
        shape.grade_sigma_percent,
        0.0..=10.0,
    )?;
    check(
        "road.largest_grade_percent",
        shape.largest_grade_percent,
        0.0..=15.0,
    )?;
    check(
        "road.largest_change_percent_per_m",
        shape.largest_change_percent_per_m,
        1e-4..=0.2,
    )?;
    check(
        "road.smallest_radius_m",
        shape.smallest_radius_m,
        100.0..=1e6,
    )?;
    if let Some(largest_radius_m) = shape.largest_radius_m {
        let widest = 1.01 * shape.smallest_radius_m..=1e9;
        check("road.largest_radius_m", largest_radius_m, widest)?;
    }
    check(
        "road.start_latitude_deg",
        shape.start_latitude_deg,
        -80.0..=80.0,
    )?;
    check(
        "road.start_longitude_deg",
        shape.start_longitude_deg,
        -170.0..=170.0,
    )?;
    check(
        "road.start_altitude_m",
        shape.start_altitude_m,
        -400.0..=6_000.0,
    )?;
    check(
        "road.start_course_deg",
        shape.start_course_deg,
        -360.0..=360.0,
    )
}
