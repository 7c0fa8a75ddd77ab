//! The vehicle identification number (VIN, ISO 3779) on a bus.
//!
//! Trucks send it as Vehicle Identification (SAE J1939-71, PGN 65260) by transport protocol, to all
//! or to the one who asked.

use super::can_frame::{CanFrame, TRANSPORT_DATA};
use embedded_can::{Frame, Id};
use estimator_core::signal::Pgn;
use std::collections::BTreeMap;

/// Vehicle Identification, VI.
const VEHICLE_IDENTIFICATION: u32 = 65_260;
/// Characters of a number.
const CHARACTERS: usize = 17;

/// Source and destination of a session.
type Pair = [u8; 2];

/// The parts of a number, and the number of the next packet.
type Partial = (Vec<u8>, u8);

/// Reader of vehicle identification.
#[derive(Debug, Default)]
pub struct VehicleNumber {
    partial: BTreeMap<Pair, Partial>,
    by_source: BTreeMap<u8, String>,
}

impl VehicleNumber {
    /// Takes a frame.
    pub fn take(&mut self, frame: &CanFrame) {
        let Id::Extended(id) = frame.id() else {
            return;
        };
        let [_, _, destination, source] = id.as_raw().to_be_bytes();
        let pair = [source, destination];
        if let Some((group, _)) = frame.announcement() {
            self.partial.remove(&pair);
            if group == VEHICLE_IDENTIFICATION {
                let whole = Vec::with_capacity(CHARACTERS);
                self.partial.insert(pair, (whole, 1));
            }
        } else if Pgn::from_raw(id.as_raw()).number == TRANSPORT_DATA
            && let [number, packet @ ..] = frame.data()
        {
            self.packet(pair, *number, packet);
        }
    }

    fn packet(&mut self, pair: Pair, number: u8, packet: &[u8]) {
        let Some((bytes, next)) = self.partial.get_mut(&pair) else {
            return;
        };
        // A packet that was asked for again.
        if number.wrapping_add(1) == *next {
            return;
        }
        let is_next = number == *next;
        if is_next {
            *next += 1;
            bytes.extend_from_slice(packet);
        }
        if !is_next || bytes.len() >= CHARACTERS {
            let (bytes, _) = self.partial.remove(&pair).unwrap_or_default();
            if let Some(number) = number_of(&bytes) {
                self.by_source.entry(pair[0]).or_insert(number);
            }
        }
    }

    /// Returns the number: of several senders, that of the lowest address. A trailer's is high.
    #[must_use]
    pub fn number(&self) -> Option<&str> {
        self.by_source.values().next().map(String::as_str)
    }
}

/// Returns the number that bytes begin with, if they are one: capitals without I, O and Q, and digits.
pub(super) fn number_of(bytes: &[u8]) -> Option<String> {
    let text = bytes.get(..CHARACTERS)?;
    let is_of_number =
        |c: &u8| c.is_ascii_digit() || c.is_ascii_uppercase() && !matches!(c, b'I' | b'O' | b'Q');
    // Some controllers that do not know theirs send zeros.
    let is_known = text.iter().any(|c| c != &text[0]);
    (is_known && text.iter().all(is_of_number)).then(|| String::from_utf8_lossy(text).into_owned())
}
