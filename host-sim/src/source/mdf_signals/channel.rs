//! A channel: where its numbers are, and what they mean.

use crate::source::mdf::conversion::{Conversion, Converted};
use crate::source::mdf::field::{Field, Invalid};
use estimator_core::signal::raw_field::RawNumber;
use std::sync::Arc;

/// A channel of a group.
#[derive(Clone, Debug)]
pub(super) struct Channel {
    pub name: String,
    pub unit: String,
    pub place: Place,
    pub conversion: Arc<Conversion>,
    pub invalid: Invalid,
    /// Why it is not read.
    pub problem: Option<Problem>,
}

/// Where the raw number is.
#[derive(Clone, Copy, Debug)]
pub(super) enum Place {
    Field(Field),
    /// It is the number of the record.
    Index,
}

/// Why a channel is not read, in words that go on "which …".
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Problem {
    /// It has no numbers.
    NoSignal(&'static str),
    Unreadable(String),
}

impl Problem {
    /// Returns the words.
    pub(super) fn words(&self) -> &str {
        match self {
            Self::NoSignal(words) => words,
            Self::Unreadable(words) => words,
        }
    }
}

/// A record: its bytes, those with its invalidation bits, and its number.
#[derive(Clone, Copy)]
pub(super) struct Record<'a> {
    pub bytes: &'a [u8],
    pub marks: &'a [u8],
    pub index: Option<u64>,
}

impl Channel {
    /// Returns whether this is its name: the whole one.
    pub(super) fn is_named(&self, name: &str) -> bool {
        self.name == name
    }

    /// Returns whether this is its name without the device, as ASAM MCD names are: `nmot\XCP:1`.
    pub(super) fn is_named_without_device(&self, name: &str) -> bool {
        self.name.split_once('\\').is_some_and(|(of, _)| of == name)
    }

    /// Reads the raw number; `None` if the record has none, or marks it as invalid.
    pub(super) fn raw(&self, record: Record) -> Option<RawNumber> {
        if self.invalid.is_set(record.marks) {
            return None;
        }
        let raw = match self.place {
            Place::Field(field) => field.number(record.bytes)?,
            Place::Index => RawNumber::Unsigned(record.index?),
        };
        raw.to_f64().is_finite().then_some(raw)
    }

    /// Converts a raw number to `unit`.
    pub(super) fn convert(&self, raw: RawNumber) -> Option<Converted> {
        match self.conversion.value(raw)? {
            Converted::Number(number) if !number.is_finite() => None,
            converted => Some(converted),
        }
    }
}
