//! One interface for each message: source arbitration between the interfaces of a log.
//!
//! The same bus may be heard on two interfaces, and two buses may have the same address. Each
//! identifier (without its priority) belongs to the interface that sends it first; its frames on
//! others are left out, unless its owner has been silent. So a fast packet is always of one
//! interface. The core arbitrates between what is left.

use super::frame_reader::LoggedFrame;
use crate::source::can_frame::CanFrame;
use crate::source::interfaces::InterfaceIndex;
use embedded_can::{Frame, Id};
use rustc_hash::FxHashMap;

/// Silence, µs, after which another interface may stand in, as between sources in the core. Twice the
/// period of the message is added.
const TIMEOUT_US: i64 = 5_000_000;
/// Most identifiers that are remembered; J1939 trucks have some hundred.
const MOST: usize = 1 << 16;
/// Bits of an identifier without its priority.
const WITHOUT_PRIORITY: u32 = 0x03ff_ffff;
/// Mark of an identifier of 11 bits.
const STANDARD: u32 = 1 << 31;

struct Ownership {
    owner: InterfaceIndex,
    /// The interface that is in use.
    user: InterfaceIndex,
    seen_us: i64,
    period_us: i64,
}

/// The interface that owns each identifier.
#[derive(Default)]
pub(super) struct InterfaceArbiter {
    identifiers: FxHashMap<u32, Ownership>,
}

fn key_of(frame: &CanFrame) -> u32 {
    match frame.id() {
        Id::Standard(id) => STANDARD | u32::from(id.as_raw()),
        Id::Extended(id) => id.as_raw() & WITHOUT_PRIORITY,
    }
}

impl InterfaceArbiter {
    /// Decides whether a frame counts. `following` are the frames that come next: where the same
    /// frame of an interface that came up before is among them, that interface gets the message.
    pub(super) fn admits<'a>(
        &mut self,
        logged: &LoggedFrame,
        mut following: impl Iterator<Item = &'a LoggedFrame>,
    ) -> bool {
        let key = key_of(&logged.frame);
        let Some(ownership) = self.identifiers.get_mut(&key) else {
            let is_older = |other: &LoggedFrame| {
                other.interface < logged.interface && other.frame == logged.frame
            };
            if logged.interface > 0 && following.any(is_older) {
                return false;
            }
            if self.identifiers.len() < MOST {
                self.identifiers.insert(key, Ownership::of(logged));
            }
            return true;
        };
        ownership.admits(logged)
    }
}

impl Ownership {
    const fn of(logged: &LoggedFrame) -> Self {
        Self {
            owner: logged.interface,
            user: logged.interface,
            seen_us: logged.micros,
            period_us: 0,
        }
    }

    fn admits(&mut self, logged: &LoggedFrame) -> bool {
        let silence_us = logged.micros - self.seen_us;
        if logged.interface == self.user {
            self.period_us = silence_us;
            self.seen_us = logged.micros;
            return true;
        }
        let patience_us = TIMEOUT_US.saturating_add(2 * self.period_us);
        if logged.interface != self.owner && silence_us <= patience_us {
            return false;
        }
        self.user = logged.interface;
        self.seen_us = logged.micros;
        true
    }
}
