//! The drives of the indicator.

use crate::drive::{Moment, value_of};
use crate::scenario::{Faults, PLAIN, Scenario};
use estimator_core::{Signal, Value};

fn given(signal: Signal, value: f32) -> Option<Value> {
    Some(value_of(signal, value))
}

/// Returns a reading whose altitude is higher by some metres.
fn raised(signal: Signal, value: f32, metres: f32) -> Option<Value> {
    match signal {
        Signal::Altitude => given(signal, value + metres),
        _ => given(signal, value),
    }
}

fn is_torque(signal: Signal) -> bool {
    matches!(signal, Signal::EngineTorque | Signal::FrictionTorque)
}

fn is_of_receiver(signal: Signal) -> bool {
    matches!(
        signal,
        Signal::FixMethod
            | Signal::Satellites
            | Signal::Hdop
            | Signal::Course
            | Signal::GnssSpeed
            | Signal::VerticalSpeed
            | Signal::Latitude
            | Signal::Longitude
            | Signal::Altitude
    )
}

fn during(moment: &Moment, from_s: f32, to_s: f32) -> bool {
    (from_s..to_s).contains(&moment.time_s)
}

/// The drives.
pub fn all() -> Vec<Scenario> {
    let mut all = of_a_day();
    all.extend(of_sensors());
    all.extend(of_signals());
    all.extend(of_receivers());
    all.extend(of_faults());
    all
}

fn of_a_day() -> Vec<Scenario> {
    vec![
        PLAIN,
        Scenario {
            name: "by force, heavy, wind",
            seed: 2,
            by_force: true,
            mass_factor: 1.15,
            headwind_mps: 3.0,
            gusts: 1.0,
            ..PLAIN
        },
        Scenario {
            name: "retarder, cold tyres, GNSS ten times a second",
            seed: 3,
            retarder: true,
            rolling_factor: 1.3,
            fix_ticks: 1,
            ..PLAIN
        },
        Scenario {
            name: "half the load from a stop on, not told",
            seed: 4,
            seconds: 900,
            stops_m: &[3_000.0, 7_000.0, 11_000.0],
            load_factor: 0.55,
            ..PLAIN
        },
        Scenario {
            name: "the load is told",
            seed: 5,
            seconds: 700,
            more: &[Signal::Mass],
            mass_factor: 0.5,
            stops_m: &[2_000.0, 6_000.0],
            stands_s: 400.0,
            load_factor: 1.6,
            ..PLAIN
        },
        Scenario {
            name: "empty, with the file of a full one",
            seed: 6,
            seconds: 900,
            mass_factor: 0.35,
            begin_mps: 0.0,
            ..PLAIN
        },
        Scenario {
            name: "all effects",
            seed: 8,
            effects: true,
            more: &[Signal::YawRate, Signal::Fan],
            headwind_mps: 2.0,
            ..PLAIN
        },
        Scenario {
            name: "stop and go",
            seed: 7,
            stops_m: &[200.0, 350.0, 600.0, 900.0, 1_300.0, 1_350.0, 2_000.0],
            stands_s: 8.0,
            begin_mps: 0.0,
            more: &[Signal::YawRate, Signal::Fan],
            ..PLAIN
        },
    ]
}

fn of_sensors() -> Vec<Scenario> {
    const TORQUE_GOES: Faults = |moment, signal, value| {
        if is_torque(signal) && during(moment, 300.0, 380.0) {
            return Some(Value::NotAvailable);
        }
        given(signal, value)
    };
    let sensors: [(&'static str, &'static [Signal]); 4] = [
        (
            "accelerometer, torque goes",
            &[Signal::LongitudinalAcceleration],
        ),
        ("pitch, torque goes", &[Signal::Pitch]),
        ("vertical speed, torque goes", &[Signal::VerticalSpeed]),
        (
            "four sensors, torque goes",
            &[
                Signal::LongitudinalAcceleration,
                Signal::Pitch,
                Signal::VerticalSpeed,
                Signal::YawRate,
                Signal::Mass,
                Signal::Fan,
            ],
        ),
    ];
    let with = |(k, (name, more)): (usize, (&'static str, &'static [Signal]))| Scenario {
        name,
        seed: 20 + k as u64,
        seconds: 600,
        more,
        mass_factor: 1.08,
        gusts: 0.3,
        faults: TORQUE_GOES,
        ..PLAIN
    };
    let mut all: Vec<Scenario> = sensors.into_iter().enumerate().map(with).collect();
    all.push(Scenario {
        name: "accelerometer, torque sticks",
        seed: 24,
        seconds: 700,
        more: &[Signal::LongitudinalAcceleration],
        faults: |moment, signal, value| {
            if is_torque(signal) && during(moment, 400.0, 470.0) {
                return Some(Value::Real(if signal == Signal::EngineTorque {
                    45.0
                } else {
                    8.0
                }));
            }
            given(signal, value)
        },
        ..PLAIN
    });
    all
}

const NO_BRAKE_SWITCH: Faults =
    |_, signal, value| (signal != Signal::BrakeSwitch).then(|| value_of(signal, value));

/// Other signals of the powertrain and of the brakes.
fn of_signals() -> Vec<Scenario> {
    const STOPS_M: &[f32] = &[500.0, 1_500.0, 4_000.0];
    let signals: [(&'static str, &'static [Signal]); 4] = [
        (
            "torque of the shaft, the ratio is told",
            &[
                Signal::NetEngineTorque,
                Signal::GearRatio,
                Signal::DrivelineEngaged,
            ],
        ),
        (
            "a motor, a clutch",
            &[
                Signal::MotorTorque,
                Signal::MotorSpeed,
                Signal::ClutchSwitch,
            ],
        ),
        (
            "shaft speed, slip, torque of auxiliaries",
            &[
                Signal::OutputShaftSpeed,
                Signal::ClutchSlip,
                Signal::ParasiticTorque,
            ],
        ),
        (
            "every brake",
            &[
                Signal::BrakeLight,
                Signal::FoundationBrake,
                Signal::BrakePedal,
                Signal::BrakePressure,
                Signal::ParkingBrake,
            ],
        ),
    ];
    let with = |(k, (name, more)): (usize, (&'static str, &'static [Signal]))| Scenario {
        name,
        seed: 60 + k as u64,
        more,
        begin_mps: 0.0,
        stops_m: STOPS_M,
        retarder: k == 3,
        faults: NO_BRAKE_SWITCH,
        ..PLAIN
    };
    signals.into_iter().enumerate().map(with).collect()
}

/// Receivers that are late or smooth what they say, and drives that go back.
fn of_receivers() -> Vec<Scenario> {
    vec![
        Scenario {
            name: "a receiver late by 1.5 s",
            seed: 70,
            seconds: 900,
            late_ticks: 15,
            fix_ticks: 2,
            stops_m: &[900.0, 1_900.0, 2_900.0, 3_900.0, 5_500.0, 7_500.0],
            stands_s: 10.0,
            ..PLAIN
        },
        Scenario {
            name: "altitudes smoothed over 15 s",
            seed: 71,
            seconds: 1_200,
            altitude_smoothed_s: 15.0,
            ..PLAIN
        },
        Scenario {
            name: "altitudes smoothed over 6 s, ten times a second",
            seed: 72,
            seconds: 900,
            fix_ticks: 1,
            altitude_smoothed_s: 6.0,
            ..PLAIN
        },
        Scenario {
            name: "wheel speeds smoothed over 2 s",
            seed: 73,
            seconds: 900,
            fix_ticks: 2,
            speed_smoothed_s: 2.0,
            stops_m: &[900.0, 1_900.0, 2_900.0, 3_900.0, 5_500.0, 7_500.0],
            stands_s: 10.0,
            ..PLAIN
        },
        Scenario {
            name: "goes back at its stops, the gear is told",
            seed: 74,
            reverses_m: 40.0,
            stops_m: &[800.0, 2_500.0, 5_000.0],
            ..PLAIN
        },
        Scenario {
            name: "goes back at its stops, no gear is told",
            seed: 75,
            reverses_m: 60.0,
            stops_m: &[800.0, 2_500.0, 5_000.0],
            faults: |_, signal, value| {
                (signal != Signal::CurrentGear).then(|| value_of(signal, value))
            },
            ..PLAIN
        },
        Scenario {
            name: "descents, no brake is told",
            seed: 76,
            seconds: 1_800,
            more: &[Signal::Mass],
            descents: 0.06,
            faults: NO_BRAKE_SWITCH,
            ..PLAIN
        },
    ]
}

fn of_faults() -> Vec<Scenario> {
    let faults: [(&'static str, Faults); 12] = [
        ("GNSS is lost", |moment, signal, value| {
            let is_lost = is_of_receiver(signal) && during(moment, 200.0, 350.0);
            (!is_lost).then(|| value_of(signal, value))
        }),
        ("altitude drifts", |moment, signal, value| {
            let drift_m = 0.15 * (moment.time_s - 250.0).clamp(0.0, 120.0);
            raised(signal, value, drift_m)
        }),
        ("altitude steps, and back", |moment, signal, value| {
            let step_m = if during(moment, 200.0, 330.0) {
                25.0
            } else {
                0.0
            };
            raised(signal, value, step_m)
        }),
        ("single altitudes are off", |moment, signal, value| {
            let is_off = (moment.time_s as u32).is_multiple_of(37);
            let off_m = if is_off { 40.0 } else { 0.0 };
            raised(signal, value, off_m)
        }),
        ("a frozen receiver", |moment, signal, value| {
            let is_frozen = during(moment, 200.0, 300.0);
            let value = match signal {
                Signal::Altitude if is_frozen => 140.0,
                _ => value,
            };
            given(signal, value)
        }),
        ("few satellites", |moment, signal, value| {
            let few = 4.0 + libm::sinf(moment.time_s / 60.0) * 2.0;
            given(
                signal,
                if signal == Signal::Satellites {
                    few
                } else {
                    value
                },
            )
        }),
        ("brakes are not told", |_, signal, value| {
            given(
                signal,
                if signal == Signal::BrakeSwitch {
                    0.0
                } else {
                    value
                },
            )
        }),
        (
            "the wheel speed sticks and leaps",
            |moment, signal, value| {
                if signal != Signal::WheelSpeed {
                    return given(signal, value);
                }
                let value = match moment.time_s {
                    s if (200.0..215.0).contains(&s) => 20.0,
                    s if (300.0..300.3).contains(&s) => value + 20.0,
                    s if (350.0..420.0).contains(&s) => 1.04 * value,
                    _ => value,
                };
                given(signal, value)
            },
        ),
        ("a silence, then another clock", |moment, signal, value| {
            (!during(moment, 200.0, 215.0) && !during(moment, 350.0, 352.0))
                .then(|| value_of(signal, value))
        }),
        ("the gear is a wrong one", |moment, signal, value| {
            let wrong = signal == Signal::CurrentGear && during(moment, 200.0, 320.0);
            given(signal, if wrong { value - 1.0 } else { value })
        }),
        (
            "no gear is told, torque in steps of 5 %",
            |_, signal, value| match signal {
                Signal::CurrentGear | Signal::ShiftInProcess => None,
                Signal::EngineTorque => given(signal, 5.0 * (value / 5.0).round()),
                _ => given(signal, value),
            },
        ),
        ("torque is held for two seconds", |moment, signal, value| {
            let is_held = signal == Signal::EngineTorque && moment.time_s % 2.0 > 0.15;
            (!is_held).then(|| value_of(signal, value))
        }),
    ];
    let with = |(k, (name, faults)): (usize, (&'static str, Faults))| Scenario {
        name,
        seed: 40 + k as u64,
        faults,
        ..PLAIN
    };
    faults.into_iter().enumerate().map(with).collect()
}
