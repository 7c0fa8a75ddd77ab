//! A mapping of own signals to start from, by the names, units and ranges of what a log has.

use super::dbc_census::DbcSignalCount;
use crate::source::own_signals::units::{contradicts, conversion};
use crate::source::signal_range::plausible_range;
use estimator_core::Signal;
use serde::Serialize;
use std::fmt::Write as _;

/// Names of short length are words of their own: `lat` is not in `Lateral`.
const SHORT: usize = 4;

/// Parts of the names that signals have in the trade, the most telling first.
const NAMES: &[(Signal, &[&str])] = &[
    (
        Signal::WheelSpeed,
        &[
            "wheelbasedvehiclespeed",
            "vehiclespeed",
            "vehspeed",
            "vehspd",
            "vspd",
            "vfzg",
            "vehvv",
            "speed",
            "spd",
        ],
    ),
    (Signal::FrontAxleSpeed, &["frontaxlespeed"]),
    (
        Signal::EngineTorque,
        &[
            "actualenginepercenttorque",
            "actengpercenttorque",
            "enginetorque",
            "engtorque",
            "engtrq",
        ],
    ),
    (Signal::MotorTorque, &["motortorque", "motortrq"]),
    (
        Signal::MotorSpeed,
        &["motorspeed", "motorspd", "rotorspeed", "motorrpm"],
    ),
    (
        Signal::FrictionTorque,
        &["nominalfriction", "frictiontorque", "frictiontrq"],
    ),
    (
        Signal::EngineSpeed,
        &[
            "enginespeed",
            "engspeed",
            "engspd",
            "enginerpm",
            "nmot",
            "rpm",
        ],
    ),
    (
        Signal::TractionForce,
        &["tractionforce", "tractiveforce", "wheelforce"],
    ),
    (Signal::GearRatio, &["gearratio", "actualgearratio"]),
    (
        Signal::CurrentGear,
        &["currentgear", "actualgear", "engagedgear", "gear"],
    ),
    (
        Signal::ShiftInProcess,
        &["shiftinprocess", "shiftinprogress", "shifting"],
    ),
    (Signal::ClutchSwitch, &["clutchswitch", "clutchpressed"]),
    (
        Signal::BrakeSwitch,
        &[
            "brakeswitch",
            "brakepressed",
            "brakeactive",
            "brakelight",
            "braking",
            "brake",
        ],
    ),
    (
        Signal::BrakePedal,
        &["brakepedalposition", "brakepedalpos", "brakepedal"],
    ),
    (
        Signal::BrakePressure,
        &["brakepressure", "brakepres", "brkpres"],
    ),
    (
        Signal::ParkingBrake,
        &["parkingbrake", "parkbrake", "handbrake"],
    ),
    (
        Signal::RetarderTorque,
        &["retardertorque", "retarderpercenttorque", "retarder"],
    ),
    (
        Signal::Mass,
        &[
            "grosscombination",
            "vehicleweight",
            "grossweight",
            "vehiclemass",
            "mass",
        ],
    ),
    (
        Signal::AmbientTemperature,
        &[
            "ambientairtemp",
            "ambienttemp",
            "outsidetemp",
            "outsideairtemp",
        ],
    ),
    (
        Signal::AirPressure,
        &["barometricpres", "ambientpres", "airpressure", "baro"],
    ),
    (
        Signal::LongitudinalAcceleration,
        &[
            "longitudinalacceleration",
            "longitudinalaccel",
            "longaccel",
            "longacc",
            "acclong",
            "accelx",
        ],
    ),
    (
        Signal::VerticalSpeed,
        &["verticalspeed", "verticalvelocity", "climbrate"],
    ),
    (Signal::PitchRate, &["pitchrate"]),
    (Signal::Pitch, &["pitchangle", "pitch"]),
    (Signal::YawRate, &["yawrate", "yaw"]),
    (Signal::Satellites, &["satellites", "numsat", "sats"]),
    (Signal::Hdop, &["hdop"]),
    (Signal::Vdop, &["vdop"]),
    (
        Signal::Course,
        &["courseoverground", "course", "heading", "cog"],
    ),
    (
        Signal::GnssSpeed,
        &["gnssspeed", "gpsspeed", "speedoverground", "sog"],
    ),
    (Signal::Latitude, &["latitude", "lat"]),
    (Signal::Longitude, &["longitude", "long", "lon", "lng"]),
    (
        Signal::Altitude,
        &["altitude", "elevation", "height", "alt"],
    ),
];

/// A proposed mapping of one signal.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Proposal {
    /// Our signal ([`Signal::column`]).
    pub signal: &'static str,
    /// Name of the message, or of the group of a channel; empty for a channel that is in one group
    /// alone.
    #[serde(skip_serializing_if = "String::is_empty")]
    pub message: String,
    /// Name of its signal.
    pub source: String,
    /// From the unit of the file to ours.
    pub scale: f64,
    /// Added after `scale`.
    pub offset: f64,
    /// The range seen, with its unit.
    pub seen: String,
    /// True if the unit is not known, and taken for ours.
    pub is_unit_unknown: bool,
}

/// Returns the best signal for each of ours, among those whose name, unit and range fit.
#[must_use]
pub fn propose(signals: &[DbcSignalCount]) -> Vec<Proposal> {
    let best = |(signal, names): &(Signal, &[&str])| {
        let fitting = signals.iter().filter_map(|found| {
            let rank = rank(&found.signal, names)?;
            // A shorter name says less else.
            Some(((rank, found.signal.len()), proposal(*signal, found)?))
        });
        fitting.min_by_key(|(rank, _)| *rank).map(|(_, best)| best)
    };
    NAMES.iter().filter_map(best).collect()
}

/// Returns the place of the first of `names` that a name has.
fn rank(name: &str, names: &[&str]) -> Option<usize> {
    let plain: String = name.chars().filter(char::is_ascii_alphanumeric).collect();
    let plain = plain.to_ascii_lowercase();
    let words = words(name);
    names.iter().position(|part| {
        if part.len() <= SHORT {
            words.iter().any(|word| word == part)
        } else {
            plain.contains(part)
        }
    })
}

/// Returns the words of a name, in lower case: `GPS_VehSpd` has three.
fn words(name: &str) -> Vec<String> {
    let mut words = vec![String::new()];
    let mut was_lower = false;
    for c in name.chars() {
        if !c.is_ascii_alphabetic() || (c.is_ascii_uppercase() && was_lower) {
            words.push(String::new());
        }
        if let Some(word) = words.last_mut()
            && c.is_ascii_alphabetic()
        {
            word.push(c.to_ascii_lowercase());
        }
        was_lower = c.is_ascii_lowercase();
    }
    words
}

fn proposal(signal: Signal, found: &DbcSignalCount) -> Option<Proposal> {
    let (min, max) = (found.min?, found.max?);
    if contradicts(&found.unit, signal) {
        return None;
    }
    let known = conversion(&found.unit, signal);
    let (scale, offset) = known.unwrap_or((1.0, 0.0));
    let (least, most) = plausible_range(signal);
    let is_plausible = |number: f64| (least..=most).contains(&(number * scale + offset));
    if !is_plausible(min) || !is_plausible(max) {
        return None;
    }
    // A switch or a number of a gear has no unit.
    let has_unit = plausible_unit(signal);
    Some(Proposal {
        signal: signal.column(),
        message: found.message.clone(),
        source: found.signal.clone(),
        scale,
        offset,
        seen: format!("{min} to {max} {}", found.unit)
            .trim_end()
            .to_owned(),
        is_unit_unknown: has_unit && known.is_none(),
    })
}

fn plausible_unit(signal: Signal) -> bool {
    !crate::source::signal_range::unit(signal).is_empty()
}

/// Returns the proposals as a `SIGNALS.toml`.
#[must_use]
pub fn to_toml(proposals: &[Proposal]) -> String {
    if proposals.is_empty() {
        return "# No signal of the log fits one of ours by name, unit and range.\n\
                # `roadgrade columns` lists ours.\n"
            .to_owned();
    }
    let tables = proposals.iter().map(|proposal| {
        let doubt = if proposal.is_unit_unknown {
            "; its unit is not known: set scale and offset"
        } else {
            ""
        };
        let mut table = format!(
            "# seen: {}{doubt}\n[signals.{}]\n",
            proposal.seen.replace(char::is_control, " "),
            proposal.signal,
        );
        if !proposal.message.is_empty() {
            let message = toml::Value::from(&*proposal.message);
            let _ = writeln!(table, "message = {message}");
        }
        let source = toml::Value::from(&*proposal.source);
        let _ = writeln!(table, "signal = {source}");
        let _ = writeln!(table, "scale = {:?}", proposal.scale);
        if proposal.offset != 0.0 {
            let _ = writeln!(table, "offset = {:?}", proposal.offset);
        }
        table
    });
    tables.collect::<Vec<_>>().join("\n")
}
