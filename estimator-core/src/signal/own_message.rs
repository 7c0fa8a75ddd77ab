//! Messages of a user's own `.dbc` file, mapped to [`Signal`]s: 11-bit identifiers, both byte orders,
//! multiplexed signals.
//!
//! They stand beside the built-in messages. The caller of the estimator decodes them and gives their
//! readings to `Estimator::on_reading`; `Estimator::reserve` keeps the same signals of built-in
//! messages out. A firmware has a table of them that is made at build time (see
//! `examples/own_dbc`). A host reads its table at run time.

use super::frame_outcome::Pgn;
use super::raw_field::{RawField, RawNumber};
use super::reading::{Reading, Signal, Value};
use embedded_can::{Frame, Id};

/// The frames of a message.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum FrameMatch {
    /// Those with this 11-bit identifier.
    Standard(u16),
    /// Those with this 29-bit identifier.
    Extended(u32),
    /// Those of this parameter group (PGN), whatever their source address and priority.
    Group(u32),
}

impl FrameMatch {
    /// Returns whether frames with this identifier are matched.
    #[must_use]
    pub fn accepts(self, id: Id) -> bool {
        match (self, id) {
            (Self::Standard(own), Id::Standard(id)) => own == id.as_raw(),
            (Self::Extended(own), Id::Extended(id)) => own == id.as_raw(),
            (Self::Group(own), Id::Extended(id)) => own == Pgn::from_raw(id.as_raw()).number,
            _ => false,
        }
    }
}

/// A multiplexer: the signal is in the payload only while it has one of these numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Multiplexer<'a> {
    /// The number that switches.
    pub field: RawField,
    /// Its numbers with which the signal is there: pairs of the least and the greatest.
    pub ranges: &'a [(u64, u64)],
}

impl Multiplexer<'_> {
    /// Returns whether the signal is in `payload`.
    #[must_use]
    pub fn selects(&self, payload: &[u8]) -> bool {
        let Some(RawNumber::Unsigned(number)) = self.field.read(payload) else {
            return false;
        };
        let within = |&(least, greatest): &(u64, u64)| (least..=greatest).contains(&number);
        self.ranges.iter().any(within)
    }
}

/// A signal of an own message, and how it becomes one of ours.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OwnSignal<'a> {
    /// What it becomes.
    pub signal: Signal,
    /// Its place in the payload.
    pub field: RawField,
    /// Multiplexers that all must select it; none for a signal that is always there.
    pub multiplexers: &'a [Multiplexer<'a>],
    /// From the raw number to the unit of [`Signal::column`]; degrees for latitude and longitude.
    pub scale: f64,
    /// Added after `scale`, in the same unit.
    pub offset: f64,
    /// Raw numbers that mean "not available".
    pub invalid: &'a [i64],
    /// Raw numbers with a value of their own, in the unit of [`Signal::column`].
    pub values: &'a [(i64, f64)],
    /// Whether the codes of SAE J1939-71 for "not available" and "error" hold.
    pub has_j1939_codes: bool,
}

impl OwnSignal<'_> {
    /// Reads the value from `payload`; `None` if the payload ends before it or a multiplexer selects
    /// another signal.
    #[must_use]
    pub fn read(&self, payload: &[u8]) -> Option<Value> {
        if !self.multiplexers.iter().all(|m| m.selects(payload)) {
            return None;
        }
        let raw = self.field.read(payload)?;
        let meant = self.values.iter().find(|(code, _)| raw.is(*code));
        Some(if self.invalid.iter().any(|code| raw.is(*code)) {
            Value::NotAvailable
        } else if let Some((_, value)) = meant {
            self.value(*value)
        } else {
            self.j1939_code(raw)
                .unwrap_or_else(|| self.value(raw.to_f64() * self.scale + self.offset))
        })
    }

    /// Returns a number of our unit as a value of the signal.
    fn value(&self, number: f64) -> Value {
        let largest_deg = match self.signal {
            Signal::Latitude => 90.0,
            Signal::Longitude => 180.0,
            _ => {
                let number = number as f32;
                return if number.is_finite() {
                    Value::Real(number)
                } else {
                    Value::Error
                };
            }
        };
        if (-largest_deg..=largest_deg).contains(&number) {
            Value::DegreesE7(libm::round(number * 1e7) as i32)
        } else {
            Value::Error
        }
    }

    /// Returns the value that a code of SAE J1939-71 stands for: the top of the raw range, a byte's
    /// worth at the head of the field.
    fn j1939_code(&self, raw: RawNumber) -> Option<Value> {
        let RawNumber::Unsigned(raw) = raw else {
            return None;
        };
        let bits = self.field.bits();
        if !self.has_j1939_codes || bits < 2 {
            return None;
        }
        let (error, not_available) = match bits.checked_sub(8) {
            Some(tail) => (0xfb << tail, 0xff << tail),
            None => ((1 << bits) - 2, (1 << bits) - 1),
        };
        if raw >= not_available {
            Some(Value::NotAvailable)
        } else if raw >= error {
            Some(Value::Error)
        } else {
            None
        }
    }
}

/// A message of a user's own `.dbc` file.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OwnMessage<'a> {
    /// Its frames.
    pub frames: FrameMatch,
    /// Its mapped signals, in the order of [`Signal`].
    pub signals: &'a [OwnSignal<'a>],
}

impl OwnMessage<'_> {
    /// Gives the readings of a payload to `sink`. Signals beyond its end give none.
    pub fn decode(&self, payload: &[u8], mut sink: impl FnMut(Reading)) {
        for own in self.signals {
            if let Some(value) = own.read(payload) {
                let signal = own.signal;
                sink(Reading { signal, value });
            }
        }
    }
}

/// Gives the readings of a frame to `sink`. Returns whether its message is among `messages`: then
/// the frame needs not to be given to the estimator unless it is a built-in message as well.
pub fn decode_own<F: Frame>(
    messages: &[OwnMessage],
    frame: &F,
    mut sink: impl FnMut(Reading),
) -> bool {
    let mut is_own = false;
    for message in messages {
        if message.frames.accepts(frame.id()) && !frame.is_remote_frame() {
            message.decode(frame.data(), &mut sink);
            is_own = true;
        }
    }
    is_own
}
