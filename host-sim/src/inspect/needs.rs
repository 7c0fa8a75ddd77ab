//! Inputs of an estimate, and the effect of each that is missing.
//!
//! The figures hold at 80 km/h for 39 t and 12 t (force over weight, as grade).

use super::census::Census;
use estimator_core::Signal;
use serde::Serialize;

/// Importance of an input.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Importance {
    /// Without it there is no useful estimate.
    Needed,
    /// The estimate works without it, and is better with it.
    Optional,
}

/// Presence of an input in a log.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Presence {
    /// The log has measurements.
    Present,
    /// The signal is always "not available" or "error", or its column is empty.
    NeverAvailable,
    /// The signal is not in the log.
    Missing,
}

/// An input of an estimate.
#[derive(Clone, Debug, Serialize)]
pub struct Need {
    /// Name.
    pub what: &'static str,
    /// Importance.
    pub importance: Importance,
    /// Presence in the log.
    pub presence: Presence,
    /// Its signals. One of them is enough; a position needs both.
    pub signals: Vec<&'static str>,
    /// Effect of its absence.
    pub without: &'static str,
    /// Remark on this log.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub note: Option<String>,
}

/// Speeds below this are standstill, m/s: one step of SPN 84 is 0.001 m/s.
const STANDING_MPS: f64 = 0.1;

const SPEED: &[Signal] = &[
    Signal::WheelSpeed,
    Signal::FrontAxleSpeed,
    Signal::TachographSpeed,
];
const TRACTION: &[Signal] = &[
    Signal::EngineTorque,
    Signal::NetEngineTorque,
    Signal::MotorTorque,
    Signal::TractionForce,
];
const TURNS: &[Signal] = &[Signal::EngineSpeed, Signal::MotorSpeed];
const REFERENCE: &[Signal] = &[Signal::EngineReferenceTorque];
const GEAR: &[Signal] = &[Signal::GearRatio, Signal::CurrentGear];
const ALTITUDE: &[Signal] = &[Signal::Altitude];
const POSITION: &[Signal] = &[Signal::Latitude, Signal::Longitude];

/// The inputs: name, importance, signals, and effect of the absence.
const LIST: &[(&str, Importance, &[Signal], &str)] = &[
    (
        "speed",
        Importance::Needed,
        SPEED,
        "no way is driven and no cell comes out",
    ),
    (
        "engine torque or traction force",
        Importance::Needed,
        TRACTION,
        "the force balance has no force: only the GNSS altitude is left, and its grade is coarse",
    ),
    (
        "GNSS altitude",
        Importance::Needed,
        ALTITUDE,
        "nothing checks the vehicle model: every error of mass, rolling or torque stays in the \
         grade (mass wrong by 10 % on a slope of 2 %: 0.12 to 0.25 %), and altitude is unknown",
    ),
    (
        "GNSS position",
        Importance::Optional,
        POSITION,
        "cells have no place on the globe: `map` has nothing to fuse",
    ),
    (
        "engine or motor speed",
        Importance::Optional,
        TURNS,
        "`map` and `identify` find no gears: give `map` the vehicle file",
    ),
    (
        "engine reference torque",
        Importance::Optional,
        REFERENCE,
        "`identify` cannot tell torque in per cent from mass: their ratio alone, which the grade needs",
    ),
    (
        "gear or gear ratio",
        Importance::Needed,
        GEAR,
        "the torque at the wheel is unknown",
    ),
    (
        "engine friction torque",
        Importance::Optional,
        &[Signal::FrictionTorque],
        "friction counts as zero and the grade reads too high, most in overrun (50 Nm: 0.07 % at \
         39 t, 0.23 % at 12 t)",
    ),
    (
        "gear shift flags",
        Importance::Optional,
        &[Signal::ShiftInProcess, Signal::DrivelineEngaged],
        "an open driveline is told from engine speed alone, and late: errors at every shift",
    ),
    (
        "brake flags",
        Importance::Optional,
        &[
            Signal::BrakeSwitch,
            Signal::BrakeLight,
            Signal::FoundationBrake,
            Signal::BrakePedal,
            Signal::BrakePressure,
        ],
        "hard braking is guessed from how the vehicle slows down, gentle braking reads as an uphill",
    ),
    (
        "retarder torque",
        Importance::Optional,
        &[Signal::RetarderTorque, Signal::RetarderForce],
        "a retarder at work reads as an uphill",
    ),
    (
        "longitudinal acceleration",
        Importance::Optional,
        &[Signal::LongitudinalAcceleration],
        "in shifts, under brakes and without torque the grade rests on GNSS alone",
    ),
    (
        "GNSS quality",
        Importance::Optional,
        &[
            Signal::Satellites,
            Signal::FixMethod,
            Signal::Hdop,
            Signal::Vdop,
        ],
        "every fix counts as a good one",
    ),
    (
        "air temperature or pressure",
        Importance::Optional,
        &[Signal::AmbientTemperature, Signal::AirPressure],
        "air has its standard density (-20 °C instead of +20 °C: 0.07 % at 39 t, 0.22 % at 12 t)",
    ),
    (
        "gross mass",
        Importance::Optional,
        &[Signal::Mass],
        "the mass of vehicle.toml holds for the whole drive, and another load is found out slowly",
    ),
];

/// Returns the inputs of an estimate with their presence in the log.
#[must_use]
pub fn needs(census: &Census) -> Vec<Need> {
    LIST.iter()
        .map(|(what, importance, signals, without)| {
            let presence = presence(census, signals);
            let mut need = Need {
                what,
                importance: *importance,
                presence,
                signals: signals.iter().map(|signal| signal.column()).collect(),
                without,
                note: None,
            };
            annotate(census, signals, &mut need);
            need
        })
        .collect()
}

fn presence(census: &Census, signals: &[Signal]) -> Presence {
    let is_half = signals == POSITION && signals.iter().any(|s| census.available(&[*s]) == 0);
    if census.available(signals) > 0 && !is_half {
        Presence::Present
    } else if census.of(signals).next().is_some() {
        Presence::NeverAvailable
    } else {
        Presence::Missing
    }
}

/// Adapts an input to the rest of the log.
fn annotate(census: &Census, signals: &[Signal], need: &mut Need) {
    if signals == SPEED {
        if census
            .largest(SPEED)
            .is_some_and(|most| most < STANDING_MPS)
        {
            need.note = Some("the vehicle never moves in this log".to_owned());
        }
    } else if signals == GEAR && need.presence != Presence::Present {
        if census.available(&[Signal::TractionForce]) > 0 {
            need.importance = Importance::Optional;
            need.without = "nothing: a measured traction force needs no gear";
        } else if census.available(&[Signal::MotorTorque]) > 0 {
            need.importance = Importance::Optional;
            need.without = "nothing where the vehicle file has one gear, a single reduction";
        } else if census.available(&[Signal::EngineSpeed]) > 0 && census.available(SPEED) > 0 {
            need.importance = Importance::Optional;
            need.without = "told from engine speed and wheel speed: late at shifts, unknown in \
                            neutral and at standstill";
        }
    } else if signals == ALTITUDE
        && need.presence != Presence::Present
        && !census.standard_ids.is_empty()
    {
        need.note = Some(format!(
            "{} identifiers of 11 bits are on this bus; if one of them is a GNSS module's, \
             `roadgrade inspect --dbc FILE.dbc LOG` with its .dbc proposes how to read it",
            census.standard_ids.len()
        ));
    }
}
