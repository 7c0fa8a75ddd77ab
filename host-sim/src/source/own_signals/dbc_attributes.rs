//! Attributes of a `.dbc` file: which messages are parameter groups of J1939, and long names.

use super::dbc_text::{behind, marked, word};
use std::collections::BTreeMap;

/// The attribute that tells parameter groups of J1939 (Vector's templates), ...
const FRAME_FORMAT: &str = "VFrameFormat";
/// ... the beginning of its value for them, and the number of that where the file does not list values.
const J1939_FORMAT: &str = "J1939";
const J1939_NUMBER: usize = 3;
/// Names of more than 32 characters are attributes; the statement has a part of them.
const LONG_MESSAGE: &str = "SystemMessageLongSymbol";
const LONG_SIGNAL: &str = "SystemSignalLongSymbol";

/// The attributes that matter, by the number of the message.
#[derive(Debug, Default)]
pub(super) struct Attributes {
    /// The values of the frame format, in order.
    formats: Vec<String>,
    default_format: Option<String>,
    of_message: BTreeMap<u32, String>,
    /// Long names of messages.
    pub messages: BTreeMap<u32, String>,
    /// Long names of signals, by message and name.
    pub signals: BTreeMap<(u32, String), String>,
}

impl Attributes {
    /// Takes a statement, if it is one of an attribute.
    pub(super) fn take(&mut self, line: &str) {
        if let Some(rest) = behind(line, "BA_") {
            self.value(rest);
        } else if let Some(rest) = behind(line, "BA_DEF_DEF_") {
            let mut rest = rest;
            if word(&mut rest) == Some(FRAME_FORMAT) {
                self.default_format = word(&mut rest).map(str::to_owned);
            }
        } else if let Some(mut rest) = behind(line, "BA_DEF_").and_then(|rest| behind(rest, "BO_"))
            && word(&mut rest) == Some(FRAME_FORMAT)
            && word(&mut rest) == Some("ENUM")
        {
            self.formats.clear();
            while let Some(format) = word(&mut rest) {
                self.formats.push(format.to_owned());
            }
        }
    }

    /// Takes what stands behind `BA_`.
    fn value(&mut self, mut rest: &str) -> Option<()> {
        let name = word(&mut rest)?;
        let object = word(&mut rest)?;
        let number = marked(word(&mut rest)?.parse().ok()?);
        match (name, object) {
            (FRAME_FORMAT, "BO_") => {
                self.of_message.insert(number, word(&mut rest)?.to_owned());
            }
            (LONG_MESSAGE, "BO_") => {
                self.messages.insert(number, word(&mut rest)?.to_owned());
            }
            (LONG_SIGNAL, "SG_") => {
                let signal = word(&mut rest)?.to_owned();
                let long = word(&mut rest)?.to_owned();
                self.signals.insert((number, signal), long);
            }
            _ => {}
        }
        Some(())
    }

    /// Returns true if a message is a parameter group of J1939: by its own value, else by the default.
    pub(super) fn is_j1939(&self, number: u32) -> bool {
        let value = self
            .of_message
            .get(&number)
            .or(self.default_format.as_ref());
        value.is_some_and(|value| match value.parse::<usize>() {
            Ok(number) => match self.formats.get(number) {
                Some(format) => format.starts_with(J1939_FORMAT),
                None => self.formats.is_empty() && number == J1939_NUMBER,
            },
            Err(_) => value.starts_with(J1939_FORMAT),
        })
    }
}
