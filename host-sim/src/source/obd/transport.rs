//! The transport of diagnostic answers: ISO 15765-2 with normal addressing, as ISO 15765-4 uses it.

use crate::source::can_frame::CanFrame;
use embedded_can::{Frame, Id};
use std::collections::BTreeMap;
use std::ops::RangeInclusive;

/// Identifiers of answers with 11 bits: up to eight controllers.
const STANDARD: RangeInclusive<u16> = 0x7e8..=0x7ef;
/// Identifiers of answers with 29 bits to the tester, without the address of the controller.
const EXTENDED: u32 = 0x18da_f100;
/// The first controller of those with 11 bits: the engine's.
const FIRST_STANDARD: u16 = 0x7e8;
/// Longest answer that is put together, bytes: six parameters have fewer.
const MOST_BYTES: usize = 256;

/// The controller that answers: 0 to 7 of those with 11 bits, else its address.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Responder {
    /// One of those with identifiers of 11 bits.
    Standard(u8),
    /// One of those with identifiers of 29 bits, by its address.
    Extended(u8),
}

impl Responder {
    /// Returns the controller whose answer a frame may be.
    pub(super) fn of(frame: &CanFrame) -> Option<Self> {
        if frame.is_remote_frame() {
            return None;
        }
        match frame.id() {
            Id::Standard(id) => {
                let id = id.as_raw();
                let index = STANDARD.contains(&id).then(|| id - FIRST_STANDARD)?;
                u8::try_from(index).ok().map(Self::Standard)
            }
            Id::Extended(id) => {
                let [.., address] = id.as_raw().to_be_bytes();
                let is_answer = id.as_raw() & !0xff == EXTENDED;
                is_answer.then_some(Self::Extended(address))
            }
        }
    }
}

/// An answer of several frames, so far.
#[derive(Clone, Debug)]
struct Partial {
    bytes: Vec<u8>,
    length: usize,
    /// Number of the next frame, modulo 16.
    next: u8,
}

/// Answers whose frames are not all there.
#[derive(Clone, Debug, Default)]
pub(super) struct Transport {
    partial: BTreeMap<Responder, Partial>,
}

impl Transport {
    /// Takes a frame of a controller. Returns the answer that it completes.
    pub(super) fn take(&mut self, responder: Responder, data: &[u8]) -> Option<Vec<u8>> {
        let (control, rest) = data.split_first()?;
        let low = control & 0xf;
        match control >> 4 {
            0 => {
                self.partial.remove(&responder);
                let length = usize::from(low);
                rest.get(..length)
                    .filter(|_| length > 0)
                    .map(<[u8]>::to_vec)
            }
            1 => {
                let (length, rest) = rest.split_first()?;
                let length = usize::from(low) << 8 | usize::from(*length);
                let partial = Partial {
                    bytes: rest.to_vec(),
                    length,
                    next: 1,
                };
                // Fewer bytes fit into a single frame.
                if (8..=MOST_BYTES).contains(&length) {
                    self.partial.insert(responder, partial);
                } else {
                    self.partial.remove(&responder);
                }
                None
            }
            2 => {
                let mut partial = self.partial.remove(&responder)?;
                if partial.next != low {
                    return None;
                }
                partial.next = (low + 1) & 0xf;
                partial.bytes.extend_from_slice(rest);
                if partial.bytes.len() >= partial.length {
                    partial.bytes.truncate(partial.length);
                    return Some(partial.bytes);
                }
                self.partial.insert(responder, partial);
                None
            }
            // Flow control is of the other direction.
            _ => None,
        }
    }
}
