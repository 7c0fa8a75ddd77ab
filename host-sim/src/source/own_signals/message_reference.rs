//! A message as `SIGNALS.toml` names it: by name, identifier or PGN.

use super::dbc::Dbc;
use super::dbc_message::DbcMessage;
use super::dbc_text::EXTENDED;
use super::mapping_file::code_of;
use crate::files::nearest::nearest_in_words;
use estimator_core::signal::own_message::FrameMatch;

/// Finds a message. Returns it with the frames that are meant: all of a parameter group where the
/// reference is a PGN. A number is an identifier first.
///
/// # Errors
/// Returns what was expected instead, with names that are spelt alike.
pub(super) fn find<'d>(
    dbc: &'d Dbc,
    reference: &str,
) -> Result<(&'d DbcMessage, FrameMatch), String> {
    if let Some(message) = dbc.messages().iter().find(|m| m.is_named(reference)) {
        return Ok((message, message.frames));
    }
    let number = code_of(reference).and_then(|number| u32::try_from(number).ok());
    let Some(number) = number else {
        let known = dbc.messages().iter().map(|message| &*message.name);
        let alike = nearest_in_words(reference, known);
        let path = dbc.path().display();
        return Err(format!("a message of {path}, such as {alike}"));
    };
    by_number(dbc, number).ok_or_else(|| {
        format!(
            "the identifier or PGN of a message of {}",
            dbc.path().display()
        )
    })
}

fn by_number(dbc: &Dbc, number: u32) -> Option<(&DbcMessage, FrameMatch)> {
    let identifier = number & !EXTENDED;
    let with = |frames: FrameMatch| {
        let message = dbc.messages().iter().find(|m| m.frames == frames);
        message.map(|message| (message, frames))
    };
    let standard = u16::try_from(number).ok().map(FrameMatch::Standard);
    standard
        .and_then(with)
        .or_else(|| with(FrameMatch::Extended(identifier)))
        .or_else(|| with_pgn(dbc, number))
        .or_else(|| {
            // The identifier of one sender, in a file that has the group.
            let (message, _) = with_pgn(dbc, pgn_of(identifier))?;
            Some((message, FrameMatch::Extended(identifier)))
        })
}

fn with_pgn(dbc: &Dbc, pgn: u32) -> Option<(&DbcMessage, FrameMatch)> {
    let message = dbc.messages().iter().find(|m| m.pgn() == Some(pgn));
    message.map(|message| (message, FrameMatch::Group(pgn)))
}

const fn pgn_of(identifier: u32) -> u32 {
    estimator_core::signal::Pgn::from_raw(identifier).number
}
