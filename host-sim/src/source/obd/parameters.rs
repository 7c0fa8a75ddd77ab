//! The parameters of current data: SAE J1979, service 01, and the same ones as data identifiers
//! F400 to F4FF of service 22 (SAE J1979-2).

use estimator_core::{Reading, Signal, Value};

/// Answer to service 01.
const CURRENT_DATA: u8 = 0x41;
/// Answer to service 22, and the high byte of identifiers that mean parameters of service 01.
const DATA_BY_IDENTIFIER: u8 = 0x62;
const PARAMETER_IDENTIFIERS: u8 = 0xf4;

/// Bytes of each parameter from 00 on; 0 for one whose length is not known.
const LENGTHS: [u8; 0xa7] = [
    4, 4, 2, 2, 1, 1, 1, 1, 1, 1, 1, 1, 2, 1, 1, 1, // 00
    2, 1, 1, 1, 2, 2, 2, 2, 2, 2, 2, 2, 1, 1, 1, 2, // 10
    4, 2, 2, 2, 4, 4, 4, 4, 4, 4, 4, 4, 1, 1, 1, 1, // 20
    1, 2, 2, 1, 4, 4, 4, 4, 4, 4, 4, 4, 2, 2, 2, 2, // 30
    4, 4, 2, 2, 2, 1, 1, 1, 1, 1, 1, 1, 1, 2, 2, 4, // 40
    4, 1, 1, 2, 2, 1, 1, 1, 1, 2, 1, 1, 1, 2, 2, 1, // 50
    4, 1, 1, 2, 5, 2, 5, 3, 0, 7, 5, 5, 5, 0, 9, 3, // 60
    0, 0, 5, 5, 5, 7, 7, 5, 9, 9, 7, 7, 9, 1, 1, 13, // 70
    4, 0, 0, 9, 1, 10, 5, 5, 13, 0, 0, 7, 17, 1, 1, 7, // 80
    3, 5, 2, 3, 12, 0, 0, 0, 9, 9, 6, 4, 17, 4, 2, 9, // 90
    4, 9, 2, 9, 4, 4, 4, // A0
];

/// One parameter and its bytes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Parameter<'a> {
    pub number: u8,
    pub data: &'a [u8],
}

/// Returns the parameters of an answer; `None` if it is of another service, or cannot be taken apart
/// without doubt.
pub(super) fn parameters(answer: &[u8]) -> Option<Vec<Parameter<'_>>> {
    let (service, mut rest) = answer.split_first()?;
    let mut found = Vec::new();
    while !rest.is_empty() {
        rest = match *service {
            CURRENT_DATA => rest,
            DATA_BY_IDENTIFIER => rest.strip_prefix(&[PARAMETER_IDENTIFIERS])?,
            _ => return None,
        };
        let (number, data) = rest.split_first()?;
        let length = usize::from(*LENGTHS.get(usize::from(*number))?);
        if length == 0 {
            return None;
        }
        let (data, behind) = data.split_at_checked(length)?;
        found.push(Parameter {
            number: *number,
            data,
        });
        rest = behind;
    }
    (!found.is_empty()).then_some(found)
}

/// Returns what an answer has in place of a vehicle identification number (VIN): information type 2
/// of service 09, or identifiers F802 and F190 of service 22 (ISO 14229-1).
pub(super) fn vehicle_number(answer: &[u8]) -> Option<&[u8]> {
    let heads = [&[0x49, 2, 1][..], &[0x62, 0xf8, 2], &[0x62, 0xf1, 0x90]];
    heads.iter().find_map(|head| answer.strip_prefix(*head))
}

/// Returns the name of a parameter that tells of motion, forces or air.
pub(super) const fn name_of(number: u8) -> Option<&'static str> {
    Some(match number {
        0x04 => "calculated engine load",
        0x0c => "engine speed",
        0x0d => "vehicle speed",
        0x10 => "air flow rate",
        0x33 => "barometric pressure",
        0x46 => "ambient air temperature",
        0x5e => "engine fuel rate",
        0x61 => "driver's demand engine torque",
        0x62 => "actual engine torque",
        0x63 => "engine reference torque",
        0x8e => "engine friction torque",
        0xa4 => "transmission actual gear",
        _ => return None,
    })
}

/// Returns the signal that a parameter gives.
pub(super) const fn signal_of(number: u8) -> Option<Signal> {
    Some(match number {
        0x0c => Signal::EngineSpeed,
        0x0d => Signal::WheelSpeed,
        0x33 => Signal::AirPressure,
        0x46 => Signal::AmbientTemperature,
        0x62 => Signal::EngineTorque,
        0x63 => Signal::EngineReferenceTorque,
        0x8e => Signal::FrictionTorque,
        0xa4 => Signal::GearRatio,
        _ => return None,
    })
}

/// Bit of the first byte of A4 that says that the ratio is supported.
const HAS_RATIO: u8 = 2;

impl Parameter<'_> {
    /// Returns the reading of the parameter, if it gives a signal.
    pub(super) fn reading(&self) -> Option<Reading> {
        let signal = signal_of(self.number)?;
        let number = match (signal, self.data) {
            (Signal::EngineSpeed, [high, low]) => {
                f32::from(u16::from_be_bytes([*high, *low])) / 4.0
            }
            (Signal::WheelSpeed, [kmh]) => f32::from(*kmh) / 3.6,
            (Signal::AirPressure, [kpa]) => f32::from(*kpa) * 1e3,
            (Signal::AmbientTemperature, [celsius]) => f32::from(*celsius) - 40.0,
            (Signal::EngineTorque | Signal::FrictionTorque, [percent]) => {
                f32::from(*percent) - 125.0
            }
            (Signal::EngineReferenceTorque, [high, low]) => {
                f32::from(u16::from_be_bytes([*high, *low]))
            }
            (Signal::GearRatio, [support, _, high, low]) if support & HAS_RATIO != 0 => {
                f32::from(u16::from_be_bytes([*high, *low])) / 1e3
            }
            _ => return None,
        };
        let value = Value::Real(number);
        Some(Reading { signal, value })
    }
}
