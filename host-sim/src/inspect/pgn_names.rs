//! Acronyms of the usual parameter groups of a truck's bus, decoded or not.

pub use crate::source::can_frame::{TRANSPORT_DATA, TRANSPORT_MANAGEMENT};

/// Groups beyond those that the core decodes, by ascending PGN (SAE J1939-21, -71, -73, -81;
/// NMEA 2000).
const NAMES: &[(u32, &str)] = &[
    (0, "TSC1"),
    (59_392, "ACKM"),
    (59_904, "RQST"),
    (TRANSPORT_DATA, "TP.DT"),
    (TRANSPORT_MANAGEMENT, "TP.CM"),
    (60_928, "AC"),
    (61_184, "PropA"),
    (61_443, "EEC2"),
    (61_450, "EGF1"),
    (61_454, "AT1IG1"),
    (61_455, "AT1OG1"),
    (65_112, "ASC4"),
    (65_134, "HRW"),
    (65_135, "ACC1"),
    (65_170, "EI1"),
    (65_197, "EBC3"),
    (65_198, "AIR1"),
    (65_214, "EEC4"),
    (65_217, "VDHR"),
    (65_226, "DM1"),
    (65_242, "SOFT"),
    (65_244, "IO"),
    (65_248, "VD"),
    (65_253, "HOURS"),
    (65_254, "TD"),
    (65_257, "LFC"),
    (65_258, "VW"),
    (65_259, "CI"),
    (65_260, "VI"),
    (65_262, "ET1"),
    (65_263, "EFL/P1"),
    (65_266, "LFE1"),
    (65_268, "TIRE"),
    (65_270, "IC1"),
    (65_271, "VEP1"),
    (65_272, "TRF1"),
    (65_276, "DD1"),
    (126_992, "SystemTime"),
    (129_540, "GnssSatsInView"),
];

/// Returns the acronym of a parameter group, if it is known.
#[must_use]
pub fn name_of(pgn: u32) -> Option<&'static str> {
    if let Some(message) = estimator_core::signal::messages().find(|m| m.pgn() == pgn) {
        return Some(message.name());
    }
    // SAE J1939-21: the last 256 groups of data page 0 are proprietary.
    if (65_280..=65_535).contains(&pgn) {
        return Some("PropB");
    }
    let index = NAMES
        .binary_search_by_key(&pgn, |(number, _)| *number)
        .ok()?;
    Some(NAMES[index].1)
}
