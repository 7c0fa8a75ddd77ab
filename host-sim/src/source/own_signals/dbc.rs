//! A `.dbc` file: the messages of a bus, and where their signals are.

use super::dbc_message::DbcMessage;
use super::dbc_text::Statements;
use crate::error::{Error, Result, without_controls};
use crate::files::limits::read_bytes;
use can_dbc::DbcError;
use std::path::{Path, PathBuf};

/// Bytes of a file: those of a whole vehicle have some megabytes.
const DBC_BYTES: u64 = 16 << 20;

/// A `.dbc` file.
#[derive(Debug)]
pub struct Dbc {
    path: PathBuf,
    messages: Vec<DbcMessage>,
}

impl Dbc {
    /// Reads a file.
    ///
    /// # Errors
    /// Returns an error if the file cannot be read, with its line for a statement that is wrong, and
    /// if it has no messages.
    pub fn read(path: &Path) -> Result<Self> {
        let statements = Statements::of(&read_bytes(path, DBC_BYTES)?);
        let dbc = can_dbc::Dbc::try_from(&*statements.text)
            .map_err(|error| located(path, &statements.text, &error))?;
        let messages: Vec<DbcMessage> = dbc
            .messages
            .iter()
            .map(|message| {
                let is_j1939 = statements.j1939.contains(&message.id.raw());
                DbcMessage::new(&dbc, message, is_j1939)
            })
            .collect();
        if messages.is_empty() {
            let problem =
                "no message; expected a .dbc file with messages, `BO_ 500 Name: 8 Sender`";
            return Err(Error::content(path, problem));
        }
        Ok(Self {
            path: path.to_owned(),
            messages,
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
}

/// Returns the error of the parser with the line of the statement.
fn located(path: &Path, text: &str, error: &DbcError) -> Error {
    // Its words have the place: " --> 12:3".
    let words = error.to_string();
    let place = words.split_once("--> ").map(|(_, place)| place);
    let line = place.and_then(|place| place.split(':').next()?.parse().ok());
    let statement = line.and_then(|line: u64| text.lines().nth(line.saturating_sub(1) as usize));
    match (line, statement) {
        (Some(line), Some(statement)) => Error::line(
            path,
            line,
            format!(
                "`{}` is not understood",
                without_controls(statement.trim(), &[])
            ),
            "a message, `BO_ 500 Name: 8 Sender`, or a signal of it, \
             `SG_ Name : 7|16@0+ (0.01,0) [0|100] \"km/h\" Receiver`",
        ),
        _ => Error::content(path, format!("{words}; expected a .dbc file")),
    }
}
