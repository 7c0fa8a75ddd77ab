//! A column of a good drive in another unit.

use crate::drive::{DRIVE, Table, at_times, estimate, table, table_of, with};
use estimator_core::Signal;
use test_kit::simulated::run;

/// Factors from m/s.
const KMH: f64 = 3.6;
const MPH: f64 = 2.236_94;

/// Changes both angles of every position.
fn positions(change: impl Fn(f64, f64) -> (f64, f64)) -> Table {
    let mut table = table();
    for (_, row) in &mut table {
        let angles = [Signal::Latitude, Signal::Longitude].map(|signal| row.get(&signal).copied());
        if let [Some(latitude), Some(longitude)] = angles {
            let (latitude, longitude) = change(latitude, longitude);
            row.insert(Signal::Latitude, latitude);
            row.insert(Signal::Longitude, longitude);
        }
    }
    table
}

fn without(table: Table, signals: &[Signal]) -> Table {
    let rows = table.into_iter().map(|(seconds, mut row)| {
        row.retain(|signal, _| !signals.contains(signal));
        (seconds, row)
    });
    rows.collect()
}

#[test]
fn wheel_speed_in_kmh_or_mph() {
    let verdict = "the wheel speed is not in m/s";
    for (factor, unit) in [(KMH, "km/h"), (MPH, "mph")] {
        let printed = estimate(&with(Signal::WheelSpeed, |mps| mps * factor));
        printed.tells(&format!("looks like {unit}"));
        printed.tells("divide km/h by 3.6");
        assert_eq!(printed.codes[0], "speed_unit", "{printed:?}");
        assert!(printed.verdict.contains(verdict), "{printed:?}");
    }
}

#[test]
fn wheel_speed_in_kmh_where_no_speed_over_ground_is_known() {
    let table = with(Signal::WheelSpeed, |mps| mps * KMH);
    let printed = estimate(&without(table, &[Signal::GnssSpeed]));
    assert_eq!(printed.codes[0], "speed_unit", "{printed:?}");
}

#[test]
fn clock_in_milliseconds_or_minutes() {
    for (factor, words) in [(1e3, "milliseconds"), (1.0 / 60.0, "minutes")] {
        let printed = estimate(&at_times(|seconds| seconds * factor));
        printed.tells(&format!("the time looks like {words}"));
        printed.tells("give time in seconds");
        // Without any cell, there is an error too, and no summary.
        let is_told = printed.verdict.contains("the clock is not in seconds");
        assert!(printed.code == 1 || is_told, "{printed:?}");
    }
}

#[test]
fn clock_that_is_not_in_seconds_is_told_without_positions() {
    let gnss = [Signal::Latitude, Signal::Longitude, Signal::GnssSpeed];
    for (factor, words) in [(1e3, "milliseconds"), (1.0 / 60.0, "minutes")] {
        let table = without(at_times(|seconds| seconds * factor), &gnss);
        estimate(&table).tells(&format!("the time looks like {words}"));
    }
}

#[test]
fn positions_in_radians() {
    let printed = estimate(&positions(|latitude, longitude| {
        (latitude.to_radians(), longitude.to_radians())
    }));
    let verdict = "the positions are not in degrees";
    printed.warns(&["positions_in_radians"], verdict, "radians");
}

#[test]
fn positions_swapped() {
    let swapped = positions(|latitude, longitude| (longitude, latitude));
    let verdict = "latitude and longitude are swapped";
    for table in [swapped.clone(), without(swapped, &[Signal::Course])] {
        estimate(&table).warns(&["positions_swapped"], verdict, "exchange");
    }
}

#[test]
fn positions_that_do_not_move() {
    let printed = estimate(&positions(|_, _| (59.0, 17.0)));
    let verdict = "the positions do not move";
    printed.warns(&["positions_frozen"], verdict, "while the wheels turn");
}

#[test]
fn course_in_radians() {
    let printed = estimate(&with(Signal::Course, f64::to_radians));
    printed.warns(&["course_unit"], "", "looks like radians");
}

#[test]
fn gnss_speed_in_kmh() {
    let printed = estimate(&with(Signal::GnssSpeed, |mps| mps * KMH));
    printed.tells("the GNSS speed is 3.6");
    assert_eq!(printed.codes[0], "gnss_speed_unit", "{printed:?}");
}

#[test]
fn torque_as_a_fraction() {
    let mut table = with(Signal::EngineTorque, |percent| percent * 0.01);
    table = without(table, &[Signal::EngineTorqueFraction]);
    let verdict = "the engine torque is not in %";
    estimate(&table).warns(&["torque_unit"], verdict, "fraction");
}

#[test]
fn torque_in_newton_metres() {
    let printed = estimate(&with(Signal::EngineTorque, |percent| percent * 17.5));
    let verdict = "the engine torque is not in %";
    printed.warns(&["torque_unit"], verdict, "looks like Nm");
}

#[test]
fn torque_that_never_changes() {
    let printed = estimate(&with(Signal::EngineTorque, |_| 20.0));
    assert_eq!(printed.codes, ["torque_constant"], "{printed:?}");
}

#[test]
fn friction_as_a_fraction() {
    let printed = estimate(&with(Signal::FrictionTorque, |percent| percent * 0.01));
    printed.warns(&["friction_torque_unit"], "", "fraction");
}

#[test]
fn altitude_in_feet() {
    let printed = estimate(&with(Signal::Altitude, |metres| metres / 0.3048));
    let verdict = "the altitude is not in m";
    printed.warns(&["altitude_unit"], verdict, "multiply feet by 0.3048");
}

#[test]
fn altitude_in_kilometres() {
    let printed = estimate(&with(Signal::Altitude, |metres| metres * 0.001));
    printed.warns(&["altitude_unit"], "the altitude is not in m", "km");
}

#[test]
fn altitude_that_never_changes() {
    let printed = estimate(&with(Signal::Altitude, |_| 100.0));
    let verdict = "the altitude never changes";
    printed.warns(&["altitude_constant"], verdict, "always 100 m");
}

#[test]
fn engine_speed_in_radians_per_second() {
    let radps = |rpm: f64| rpm * std::f64::consts::PI / 30.0;
    let table = with(Signal::EngineSpeed, radps);
    let gears = [Signal::CurrentGear, Signal::SelectedGear, Signal::GearRatio];
    let verdict = "the engine speed is not in rpm";
    for table in [table.clone(), without(table, &gears)] {
        let printed = estimate(&table);
        printed.tells("multiply rad/s by 9.5493");
        assert_eq!(
            printed.codes.first().map(String::as_str),
            (printed.code == 0).then_some("engine_speed_unit")
        );
        assert!(
            printed.code == 1 || printed.verdict.contains(verdict),
            "{printed:?}"
        );
    }
}

/// Adds a signal to each row in which the brake switch is reported.
fn from_brake_switch(signal: Signal, value: impl Fn(f64) -> f64) -> Table {
    let mut table = table();
    for (_, row) in &mut table {
        if let Some(switch) = row.get(&Signal::BrakeSwitch).copied() {
            row.insert(signal, value(switch));
        }
    }
    table
}

#[test]
fn brake_pressure_in_bar() {
    let verdict = "the brake pressure is not in Pa";
    let bar = from_brake_switch(Signal::BrakePressure, |switch| 0.05 + 3.0 * switch);
    estimate(&bar).warns(&["brake_pressure_unit"], verdict, "looks like bar");
    let pa = from_brake_switch(Signal::BrakePressure, |switch| 5e3 + 3e5 * switch);
    assert_eq!(estimate(&pa).codes, [""; 0]);
}

#[test]
fn retarder_torque_of_the_wrong_sign() {
    let wrong = from_brake_switch(Signal::RetarderTorque, |switch| 40.0 * switch);
    let verdict = "the retarder torque has the wrong sign";
    estimate(&wrong).warns(&["retarder_sign"], verdict, "below zero where it brakes");
    let right = from_brake_switch(Signal::RetarderTorque, |switch| -40.0 * switch);
    assert_eq!(estimate(&right).codes, [""; 0]);
}

#[test]
fn temperature_in_kelvin_or_fahrenheit() {
    for (celsius, unit) in [(293.0, "K"), (86.0, "°F")] {
        let printed = estimate(&with(Signal::AmbientTemperature, |_| celsius));
        printed.warns(&["temperature_unit"], "", &format!("looks like {unit}"));
    }
}

#[test]
fn air_pressure_in_hectopascals() {
    let printed = estimate(&with(Signal::AirPressure, |pa| pa * 0.01));
    printed.warns(&["air_pressure_unit"], "", "multiply hPa by 100");
}

#[test]
fn yaw_rate_in_degrees_per_second() {
    let mut side = 0.0;
    let printed = estimate(&with(Signal::YawRate, |_| {
        side = 0.04 - side;
        side * 57.3
    }));
    printed.warns(&["yaw_rate_unit"], "", "looks like °/s");
}

/// Returns the drive with an accelerometer, in this message, whose readings are changed.
fn with_accelerometer(message: &str, change: impl Fn(f64) -> f64) -> Table {
    let sensor = format!("[accelerometer]\nmessage = \"{message}\"\n");
    with_sensor(&sensor, Signal::LongitudinalAcceleration, change)
}

/// Returns the drive with a sensor more, whose readings are changed.
fn with_sensor(sensor: &str, signal: Signal, change: impl Fn(f64) -> f64) -> Table {
    let (seed, rest) = DRIVE.split_once('\n').unwrap();
    let mut table = table_of(&run(&[seed, "\n", sensor, rest]));
    for (_, row) in &mut table {
        if let Some(value) = row.get_mut(&signal) {
            *value = change(*value);
        }
    }
    table
}

#[test]
fn an_accelerometer_upside_down_or_in_another_unit() {
    for message in ["ACCS", "VDC2"] {
        let right = with_accelerometer(message, |mps2| mps2);
        assert_eq!(estimate(&right).codes, [""; 0], "{message}");
        let upside_down = with_accelerometer(message, |mps2| -mps2);
        estimate(&upside_down).warns(&["accelerometer_sign"], "", "it is upside down");
        let in_g = with_accelerometer(message, |mps2| mps2 / 9.806_65);
        estimate(&in_g).warns(&["accelerometer_unit"], "", "it looks like g");
        let in_centimetres = with_accelerometer(message, |mps2| 10.0 * mps2);
        estimate(&in_centimetres).warns(&["accelerometer_unit"], "", "in m/s²");
    }
}

#[test]
fn reported_mass_in_tonnes() {
    let tonnes = from_brake_switch(Signal::Mass, |_| 39.0);
    estimate(&tonnes).warns(&["mass_unit"], "", "looks like tonnes");
    let kg = from_brake_switch(Signal::Mass, |_| 39_000.0);
    assert_eq!(estimate(&kg).codes, [""; 0]);
}

#[test]
fn a_brake_switch_that_is_always_on() {
    let printed = estimate(&with(Signal::BrakeSwitch, |_| 1.0));
    let verdict = "a brake is always on";
    printed.warns(
        &["always_braking"],
        verdict,
        "switches are 1 where a brake is on",
    );
}

#[test]
fn engine_speed_in_degrees_per_second_or_raw() {
    for factor in [6.0, 8.0] {
        let printed = estimate(&with(Signal::EngineSpeed, |rpm| factor * rpm));
        printed.warns(
            &["engine_speed_unit"],
            "the engine speed is not in rpm",
            "turns faster than engines do",
        );
    }
}

#[test]
fn torque_of_the_wrong_sign() {
    let printed = estimate(&with(Signal::EngineTorque, |percent| -percent));
    let verdict = "the engine torque has the wrong sign";
    printed.warns(&["torque_sign"], verdict, "would only brake");
}

#[test]
fn altitude_of_the_wrong_sign() {
    let printed = estimate(&with(Signal::Altitude, |metres| -metres));
    let verdict = "the altitude is not in m";
    printed.warns(&["altitude_unit"], verdict, "their sign is wrong");
}

#[test]
fn wheel_speed_of_the_wrong_sign() {
    let printed = estimate(&with(Signal::WheelSpeed, |mps| -mps));
    assert_eq!(printed.code, 1);
    printed.tells("the speed is below zero");
}

#[test]
fn clock_in_milliseconds_is_told_first() {
    let printed = estimate(&at_times(|seconds| 1e3 * seconds));
    let first = printed.stderr.lines().next().unwrap_or_default();
    assert!(
        first.contains("the time looks like milliseconds"),
        "{first}"
    );
}

#[test]
fn driveline_switch_the_other_way_round() {
    let printed = estimate(&with(Signal::DrivelineEngaged, |engaged| 1.0 - engaged));
    let verdict = "the driveline is reported open nearly always";
    printed.warns(&["driveline_open"], verdict, "1 is engaged");
}

#[test]
fn gears_that_are_raw_numbers_or_not_those_of_the_file() {
    for (offset, code) in [(1.0, "gear_number"), (125.0, "no_gear")] {
        let table = with(Signal::CurrentGear, |gear| gear + offset);
        let table = without(table, &[Signal::GearRatio]);
        let printed = estimate(&table);
        assert_eq!(printed.codes, [code], "{printed:?}");
    }
    for change in [|ratio: f64| 100.0 * ratio, |ratio: f64| ratio + 1.0] {
        let printed = estimate(&with(Signal::GearRatio, change));
        assert_eq!(printed.codes, ["gear_ratio_unit"], "{printed:?}");
    }
}
