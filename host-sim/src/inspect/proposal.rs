//! A mapping of own signals to start from, by the names, units and ranges of what a log has.

use super::census::Census;
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
    /// True if some values are beyond what the signal can be.
    pub has_others: bool,
    /// The largest value that is usual, in our unit.
    #[serde(skip)]
    pub most: f64,
}

/// Words of names that mean another number than the quantity itself.
const NO_QUANTITY: &[&str] = &[
    "accuracy",
    "cruise",
    "demand",
    "desired",
    "deviation",
    "error",
    "limit",
    "limiter",
    "max",
    "min",
    "quality",
    "requested",
    "set",
    "sigma",
    "status",
    "target",
    "valid",
    "validity",
];
/// Words of a receiver's messages.
const RECEIVER: &[&str] = &["gnss", "gps", "nmea"];
/// The vehicle's own speeds. A receiver's is another one, which checks these.
const OWN_SPEEDS: [Signal; 3] = [
    Signal::WheelSpeed,
    Signal::FrontAxleSpeed,
    Signal::TachographSpeed,
];
/// Readings from which on a number that never changes is suspicious.
const MANY: u64 = 20;
/// Largest ratio of the top speeds in one drive by two senders.
const MOST_RATIO: f64 = 2.0;
/// Top speed from which on this ratio tells, m/s.
const FAST_MPS: f64 = 5.0;

/// Returns the best signal for each of ours that `census` does not have, among those whose name, unit
/// and range fit.
#[must_use]
pub fn propose(signals: &[DbcSignalCount], census: &Census) -> Vec<Proposal> {
    let is_missing = |signal: Signal| census.available(&[signal]) == 0;
    let has_own_speed = !OWN_SPEEDS.into_iter().all(is_missing);
    let best = |(signal, names): &(Signal, &[&str])| {
        if !is_missing(*signal) || (has_own_speed && OWN_SPEEDS.contains(signal)) {
            return None;
        }
        let fitting = signals.iter().filter_map(|found| {
            let rank = rank_as(*signal, found, names)?;
            let is_constant = found.min == found.max && found.count >= MANY;
            // A shorter name says less else.
            let rank = (is_constant, rank, found.signal.len());
            Some((rank, proposal(*signal, found)?))
        });
        fitting.min_by_key(|(rank, _)| *rank).map(|(_, best)| best)
    };
    let mut found: Vec<Proposal> = NAMES.iter().filter_map(best).collect();
    let of = |found: &[Proposal], signal: Signal| {
        let mut of = found.iter().filter(|found| found.signal == signal.column());
        of.next().map(|found| found.most)
    };
    let top = census.largest(&OWN_SPEEDS);
    if let Some(top) = top
        .or_else(|| of(&found, Signal::GnssSpeed))
        .filter(|top| *top > FAST_MPS)
    {
        let is_speed = |found: &Proposal| {
            let signal = Signal::from_column(found.signal);
            signal.is_some_and(|signal| signal == Signal::GnssSpeed || OWN_SPEEDS.contains(&signal))
        };
        let range = top / MOST_RATIO..=top * MOST_RATIO;
        found.retain(|found| !is_speed(found) || range.contains(&found.most));
    }
    found
}

/// Returns the rank of a signal's name as one of ours; `None` if it is another one.
fn rank_as(signal: Signal, found: &DbcSignalCount, names: &[&str]) -> Option<usize> {
    let of_name = words(&found.signal);
    let has = |words: &[String], of: &[&str]| words.iter().any(|word| of.contains(&word.as_str()));
    if has(&of_name, NO_QUANTITY) {
        return None;
    }
    let is_of_receiver = has(&of_name, RECEIVER) || has(&words(&found.message), RECEIVER);
    match signal {
        signal if OWN_SPEEDS.contains(&signal) && is_of_receiver => None,
        Signal::GnssSpeed if is_of_receiver => {
            rank(&found.signal, names).or_else(|| rank(&found.signal, &["speed", "spd"]))
        }
        _ => rank(&found.signal, names),
    }
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
    let (low, high) = found.usual.unwrap_or((min, max));
    if !is_plausible(low) || !is_plausible(high) {
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
        has_others: !is_plausible(min) || !is_plausible(max),
        most: (low * scale + offset).max(high * scale + offset),
    })
}

fn plausible_unit(signal: Signal) -> bool {
    !crate::source::signal_range::unit(signal).is_empty()
}

impl Proposal {
    /// Returns what was seen of the signal, as a comment of TOML.
    pub(super) fn comment(&self) -> String {
        let doubt = if self.is_unit_unknown {
            "; its unit is not known: set scale and offset"
        } else {
            ""
        };
        let others = if self.has_others {
            "; a few are beyond what it can be: set invalid if they mean \"not available\""
        } else {
            ""
        };
        let seen = self.seen.replace(char::is_control, " ");
        format!("# seen: {seen}{doubt}{others}\n")
    }
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
        let mut table = format!("{}[signals.{}]\n", proposal.comment(), proposal.signal,);
        if !proposal.message.is_empty() {
            let message = toml::Value::from(&*proposal.message);
            let _ = writeln!(table, "message = {message}");
        }
        let source = toml::Value::from(&*proposal.source);
        let _ = writeln!(table, "signal = {source}");
        let scale = format!("scale = {:?}", proposal.scale);
        // Without it, a unit that is not known is an error.
        let mark = if proposal.is_unit_unknown { "# " } else { "" };
        let _ = writeln!(table, "{mark}{scale}");
        if proposal.offset != 0.0 {
            let _ = writeln!(table, "offset = {:?}", proposal.offset);
        }
        table
    });
    tables.collect::<Vec<_>>().join("\n")
}
