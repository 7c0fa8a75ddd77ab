//! A `.dbc` file: the messages of a bus, and where their signals are.

use super::dbc_attributes::Attributes;
use super::dbc_message::DbcMessage;
use super::dbc_statement::{message, signal, signal_name};
use super::dbc_text::{behind, decoded, marked, statements, word};
use super::message_parts::MessageParts;
use crate::error::{Error, Result, without_controls};
use crate::files::left_out::LeftOut;
use crate::files::limits::read_bytes;
use estimator_core::signal::raw_field::NumberKind;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// Bytes of a file: those of a whole vehicle have some megabytes.
const DBC_BYTES: u64 = 16 << 20;
/// The number of the message that has signals of no message.
const NO_MESSAGE: u32 = 0xc000_0000;
const EXPECTED: &str = "a message, `BO_ 500 Name: 8 Sender`, or a signal of it, \
                        `SG_ Name : 7|16@0+ (0.01,0) [0|100] \"km/h\" Receiver`";

/// A `.dbc` file.
#[derive(Debug)]
pub struct Dbc {
    path: PathBuf,
    messages: Vec<DbcMessage>,
    left_out: LeftOut,
}

impl Dbc {
    /// Reads a file. A statement that is not understood is left out, alone.
    ///
    /// # Errors
    /// Returns an error if the file cannot be read, or has no message.
    pub fn read(path: &Path) -> Result<Self> {
        let bytes = read_bytes(path, DBC_BYTES)?;
        let mut reader = Reader::default();
        let mut left_out = LeftOut::default();
        let mut first = None;
        for (number, line) in statements(&decoded(&bytes)) {
            if reader.take(line).is_none() {
                let shown = without_controls(line, &[]);
                let problem = format!("`{shown}` is not understood");
                let error = Error::line(path, number, problem, EXPECTED);
                left_out.add(error.to_string());
                first.get_or_insert(error);
            }
        }
        if reader.messages.is_empty() {
            let problem =
                "no message; expected a .dbc file with messages, `BO_ 500 Name: 8 Sender`";
            return Err(first.unwrap_or_else(|| Error::content(path, problem)));
        }
        let messages = reader.messages.iter();
        Ok(Self {
            path: path.to_owned(),
            messages: messages
                .map(|parts| DbcMessage::new(parts, &reader.attributes))
                .collect(),
            left_out,
        })
    }

    /// Returns the path, for messages.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Returns its messages.
    #[must_use]
    pub fn messages(&self) -> &[DbcMessage] {
        &self.messages
    }

    /// Returns what is left out: each statement that is not understood, with its line.
    #[must_use]
    pub const fn left_out(&self) -> &LeftOut {
        &self.left_out
    }
}

/// The statements so far.
#[derive(Default)]
struct Reader {
    messages: Vec<MessageParts>,
    /// Their places in the list, by number.
    places: BTreeMap<u32, usize>,
    attributes: Attributes,
    /// True while signals belong to the newest message.
    is_in_message: bool,
}

const NOT_UNDERSTOOD: &str = "is described by a statement that is not understood";

impl Reader {
    /// Takes a statement; `None` if it is not understood.
    fn take(&mut self, line: &str) -> Option<()> {
        if let Some(rest) = behind(line, "BO_") {
            self.is_in_message = false;
            let found = message(rest)?;
            self.is_in_message = found.number != NO_MESSAGE;
            if self.is_in_message {
                let number = marked(found.number);
                self.places.entry(number).or_insert(self.messages.len());
                self.messages.push(MessageParts {
                    number,
                    name: found.name.to_owned(),
                    signals: Vec::new(),
                    kinds: BTreeMap::new(),
                    switches: BTreeMap::new(),
                });
            }
        } else if let Some(rest) = behind(line, "SG_") {
            if self.is_in_message {
                return self.signal(rest);
            }
        } else if let Some(rest) = behind(line, "SIG_VALTYPE_") {
            return self.kind(rest);
        } else if let Some(rest) = behind(line, "SG_MUL_VAL_") {
            return self.switch(rest);
        } else {
            self.attributes.take(line);
        }
        Some(())
    }

    fn signal(&mut self, rest: &str) -> Option<()> {
        let name = signal_name(rest)?.to_owned();
        let found = signal(rest);
        let is_understood = found.is_some();
        let found = found.ok_or_else(|| NOT_UNDERSTOOD.to_owned());
        self.messages.last_mut()?.signals.push((name, found));
        is_understood.then_some(())
    }

    /// Returns the message with a number, if the file has it.
    fn message(&mut self, number: &str) -> Option<Option<&mut MessageParts>> {
        let number = marked(number.parse().ok()?);
        let place = self.places.get(&number);
        Some(place.and_then(|place| self.messages.get_mut(*place)))
    }

    /// Reads `1264 Height : 1;`.
    fn kind(&mut self, mut rest: &str) -> Option<()> {
        let message = word(&mut rest)?;
        let signal = word(&mut rest)?.to_owned();
        let kind = match word(&mut rest) {
            // The sign of an integer stands with the signal.
            Some("0") => return Some(()),
            Some("1") => Ok(NumberKind::Float32),
            Some("2") => Ok(NumberKind::Float64),
            _ => Err(NOT_UNDERSTOOD.to_owned()),
        };
        let is_understood = kind.is_ok();
        if let Some(parts) = self.message(message)? {
            parts.kinds.insert(signal, kind);
        }
        is_understood.then_some(())
    }

    /// Reads `1 Speed Page 1-1, 5-7;`.
    fn switch(&mut self, mut rest: &str) -> Option<()> {
        let message = word(&mut rest)?;
        let signal = word(&mut rest)?.to_owned();
        let switch = word(&mut rest)?.to_owned();
        let ranges = rest.trim_end_matches([';', ' ']).split(',').map(|range| {
            let (least, most) = range.trim().split_once('-')?;
            Some((least.trim().parse().ok()?, most.trim().parse().ok()?))
        });
        let ranges: Option<Vec<(u64, u64)>> = ranges.collect();
        let is_understood = ranges.is_some();
        let found = ranges.map(|ranges| (switch, ranges));
        let found = found.ok_or_else(|| NOT_UNDERSTOOD.to_owned());
        if let Some(parts) = self.message(message)? {
            parts.switches.insert(signal, found);
        }
        is_understood.then_some(())
    }
}
