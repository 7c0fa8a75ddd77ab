//! Where each of our signals comes from: the built-in messages of each bus.

use can_dbc::{Comment, Dbc, DbcError, Message};
use estimator_core::Signal;
use estimator_core::signal::{J1939_DBC, NMEA2000_DBC, Pgn};
use serde::Serialize;

/// The layouts that the core is built with.
const LAYOUTS: [(&str, &str); 2] = [("J1939", J1939_DBC), ("NMEA 2000", NMEA2000_DBC)];

/// A built-in message that has a signal.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct SignalSource {
    /// The bus.
    pub bus: &'static str,
    /// Acronym of the message.
    pub message: String,
    /// Its parameter group number.
    pub pgn: u32,
    /// Number of the signal in SAE J1939-71, if it has one.
    pub spn: Option<u32>,
}

/// The layouts of all buses.
pub struct BuiltIn {
    layouts: Vec<(&'static str, Dbc)>,
}

impl BuiltIn {
    /// Reads the layouts.
    ///
    /// # Errors
    /// Returns the parser's error; the layouts are part of the program.
    pub fn read() -> Result<Self, DbcError> {
        let read = |(bus, text)| Dbc::try_from(text).map(|layout| (bus, layout));
        let layouts = LAYOUTS.into_iter().map(read).collect::<Result<_, _>>()?;
        Ok(Self { layouts })
    }

    /// Returns the messages that have a signal.
    #[must_use]
    pub fn sources_of(&self, signal: Signal) -> Vec<SignalSource> {
        // The layouts name a signal as its variant.
        let name = format!("{signal:?}");
        let mut sources = Vec::new();
        for (bus, layout) in &self.layouts {
            let has = |message: &&Message| message.signals.iter().any(|of| of.name == name);
            sources.extend(
                layout
                    .messages
                    .iter()
                    .filter(has)
                    .map(|message| SignalSource {
                        bus,
                        message: message.name.clone(),
                        pgn: Pgn::from_raw(message.id.raw()).number,
                        spn: spn(layout, message, &name),
                    }),
            );
        }
        sources
    }
}

/// Returns the number that the comment of a signal begins with: "SPN 84".
fn spn(layout: &Dbc, message: &Message, signal: &str) -> Option<u32> {
    let comment = layout.comments.iter().find_map(|comment| match comment {
        Comment::Signal {
            message_id,
            name,
            comment,
        } if *message_id == message.id && name == signal => Some(comment),
        _ => None,
    })?;
    let number = comment.strip_prefix("SPN ")?;
    let end = number.find(|c: char| !c.is_ascii_digit());
    number[..end.unwrap_or(number.len())].parse().ok()
}
