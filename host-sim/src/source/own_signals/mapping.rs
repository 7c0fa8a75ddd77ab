//! A mapping of own signals, ready to decode frames.

use super::dbc::Dbc;
use super::dbc_message::Switch;
use super::mapping_file::{MESSAGE, MappingEntry, MappingFile};
use super::{message_reference, units};
use crate::error::Result;
use crate::files::left_out::LeftOut;
use crate::files::nearest::nearest_in_words;
use crate::source::can_frame::CanFrame;
use embedded_can::Frame;
use estimator_core::signal::own_message::{FrameMatch, OwnSignal};
use estimator_core::signal::raw_field::RawField;
use estimator_core::{Reading, Signal};
use std::path::Path;

/// Own signals: which frames have them, and how they become ours.
#[derive(Clone, Debug, PartialEq)]
pub struct OwnSignals {
    messages: Vec<Message>,
    left_out: LeftOut,
}

/// The mapped signals of one message.
#[derive(Clone, Debug, PartialEq)]
struct Message {
    frames: FrameMatch,
    /// In the order of [`Signal`].
    signals: Vec<Mapped>,
}

/// One mapped signal.
#[derive(Clone, Debug, PartialEq)]
struct Mapped {
    signal: Signal,
    field: RawField,
    multiplexers: Vec<Switch>,
    scale: f64,
    offset: f64,
    invalid: Vec<i64>,
    values: Vec<(i64, f64)>,
    has_j1939_codes: bool,
}

impl OwnSignals {
    /// Reads a `.dbc` file and a `SIGNALS.toml`.
    ///
    /// # Errors
    /// Names the file, the line and the key that is wrong, with names that are spelt alike.
    pub fn read(dbc: &Path, mapping: &Path) -> Result<Self> {
        let dbc = Dbc::read(dbc)?;
        let file = MappingFile::read(mapping)?;
        let mut messages: Vec<Message> = Vec::new();
        for entry in &file.entries {
            let (frames, mapped) = mapped(&dbc, &file, entry)?;
            match messages.iter_mut().find(|m| m.frames == frames) {
                Some(message) => message.signals.push(mapped),
                None => messages.push(Message {
                    frames,
                    signals: vec![mapped],
                }),
            }
        }
        Ok(Self {
            messages,
            left_out: dbc.left_out().clone(),
        })
    }

    /// Returns what was left out of the `.dbc` file, each with its line.
    #[must_use]
    pub const fn left_out(&self) -> &LeftOut {
        &self.left_out
    }

    /// Returns the mapped signals of ours.
    pub fn signals(&self) -> impl Iterator<Item = Signal> {
        let signals = self.messages.iter().flat_map(|message| &message.signals);
        signals.map(|mapped| mapped.signal)
    }

    /// Returns the frames that have them.
    pub fn frames(&self) -> impl Iterator<Item = FrameMatch> {
        self.messages.iter().map(|message| message.frames)
    }

    /// Gives the readings of a frame to `sink`, those of one message in the order of [`Signal`].
    pub fn decode(&self, frame: &CanFrame, mut sink: impl FnMut(Reading)) {
        for message in &self.messages {
            if message.frames.accepts(frame.id()) && !frame.is_remote_frame() {
                for mapped in &message.signals {
                    mapped.read(frame.data(), &mut sink);
                }
            }
        }
    }
}

impl Mapped {
    fn read(&self, payload: &[u8], mut sink: impl FnMut(Reading)) {
        let own = OwnSignal {
            signal: self.signal,
            field: self.field,
            multiplexers: &[],
            scale: self.scale,
            offset: self.offset,
            invalid: &self.invalid,
            values: &self.values,
            has_j1939_codes: self.has_j1939_codes,
        };
        if self
            .multiplexers
            .iter()
            .all(|switch| switch.selects(payload))
            && let Some(value) = own.read(payload)
        {
            let signal = self.signal;
            sink(Reading { signal, value });
        }
    }
}

/// Finds what an entry names in the `.dbc` file.
fn mapped(dbc: &Dbc, file: &MappingFile, entry: &MappingEntry) -> Result<(FrameMatch, Mapped)> {
    let name = entry.signal.column();
    let key =
        |key: &str, value: &str| format!("signals.{name}.{key} is `{}`", value.escape_debug());
    let Some(reference) = &entry.message else {
        let problem = format!("signals.{name}.message is missing");
        return Err(file.error(entry.line, problem, MESSAGE));
    };
    let (message, frames) = message_reference::find(dbc, &reference.value).map_err(|expected| {
        file.error(reference.line, key("message", &reference.value), expected)
    })?;
    let source = &entry.source;
    let Some(found) = message.signals.iter().find(|s| s.is_named(&source.value)) else {
        let alike = nearest_in_words(&source.value, message.signals.iter().map(|s| &*s.name));
        let expected = format!("a signal of message {}, such as {alike}", message.name);
        return Err(file.error(source.line, key("signal", &source.value), expected));
    };
    let field = found.field.as_ref().map_err(|problem| {
        let path = dbc.path().display();
        let problem = format!("{}, which {problem}", key("signal", &source.value));
        file.error(
            source.line,
            problem,
            format!("a signal of {path} that a frame can have"),
        )
    })?;
    let (scale, offset) = units::conversion_of(file, entry, &found.name, &found.unit)?;
    let mapped = Mapped {
        signal: entry.signal,
        field: *field,
        multiplexers: found.multiplexers.clone(),
        scale: found.factor * scale,
        offset: found.offset * scale + offset,
        invalid: entry.invalid.clone(),
        values: entry.values.clone(),
        has_j1939_codes: matches!(frames, FrameMatch::Group(_)),
    };
    Ok((frames, mapped))
}
