//! An electric car: its vehicle file, and a signal table of ten minutes over hills.

use std::fmt::Write as _;

/// Its vehicle file.
pub const VEHICLE: &str = "[vehicle]\nname = \"car\"\nmass_kg = 1500.0\ndrag_area_m2 = 0.7\n\
    rolling_resistance = 0.01\nwheel_radius_m = 0.31\nwheel_inertia_kgm2 = 4.0\n\
    [powertrain]\nengine_inertia_kgm2 = 0.0\nreference_torque_nm = 250.0\n\
    final_drive_ratio = 9.665\nfinal_drive_efficiency = 1.0\n\
    gears = [{ ratio = 1.0, efficiency = 1.0 }]\n";

/// Standard gravity, m/s², and what the wheels add to the mass, kg.
const GRAVITY: f64 = 9.806_65;
const ROTATING_KG: f64 = 4.0 / (0.31 * 0.31);

/// Returns the grade of its road at a distance, 1.
#[must_use]
pub fn slope(distance_m: f64) -> f64 {
    0.03 * (distance_m / 400.0).sin()
}

/// Returns a signal table with every column of such a car, every 100 ms; its motor brakes downhill.
///
/// # Panics
/// Never: a text can be written to.
#[must_use]
pub fn table() -> String {
    let mut text = "time_s,motor_torque_nm,motor_speed_rpm,brake_light,retarder_force_n,\
        longitudinal_acceleration_mps2,pitch_deg,pitch_rate_radps,vertical_speed_mps,altitude_m,\
        wheel_speed_mps\n"
        .to_owned();
    let mut distance_m = 0.0_f64;
    for k in 0..6000 {
        let time_s = 0.1 * f64::from(k);
        let speed_mps = 20.0 + 3.0 * (time_s / 40.0).sin();
        let gained_mps2 = 3.0 / 40.0 * (time_s / 40.0).cos();
        distance_m += 0.1 * speed_mps;
        let sine = slope(distance_m) / (1.0 + slope(distance_m).powi(2)).sqrt();
        let force_n = 1500.0 * GRAVITY * (sine + 0.01)
            + 0.6 * 0.7 * speed_mps * speed_mps
            + (1500.0 + ROTATING_KG) * gained_mps2;
        let torque_nm = force_n * 0.31 / 9.665;
        let altitude_m = 400.0 + 12.0 * (1.0 - (distance_m / 400.0).cos());
        let altitude = if k % 10 == 0 {
            altitude_m.to_string()
        } else {
            String::new()
        };
        writeln!(
            text,
            "{time_s:.1},{torque_nm:.2},{:.0},0,0,{:.3},{:.3},0.0,{:.2},{altitude},{speed_mps:.3}",
            speed_mps / 0.31 * 9.665 * 30.0 / std::f64::consts::PI,
            gained_mps2 + GRAVITY * sine,
            sine.asin().to_degrees(),
            speed_mps * sine,
        )
        .unwrap();
    }
    text
}
