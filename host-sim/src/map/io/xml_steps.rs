//! The elements of an XML file, one after the other.

use crate::error::{Error, Result};
use crate::files::limits::Budget;
use crate::files::unpacked::{self, ROAD_ENDINGS};
use encoding_rs::{Encoding, UTF_8};
use encoding_rs_io::DecodeReaderBytesBuilder;
use quick_xml::Reader;
use quick_xml::escape::resolve_predefined_entity;
use quick_xml::events::{BytesRef, BytesStart, Event};
use std::io::{BufReader, Read};
use std::path::Path;

/// Bytes of one element or text: a line of 2,500 km.
const ELEMENT_BYTES: usize = 8 << 20;

/// Bytes in which the declaration of XML ends.
const DECLARATION_BYTES: u64 = 256;

/// A step through a file. Names are those without their prefix.
pub(super) enum Step<'a> {
    Open(&'a str, &'a Element<'a>),
    Text(&'a str),
    Close(&'a str),
}

/// The attributes of an element.
pub(super) struct Element<'a>(BytesStart<'a>);

impl Element<'_> {
    /// Returns the value of an attribute.
    pub(super) fn text(&self, name: &str) -> Option<String> {
        let attribute = self.0.try_get_attribute(name).ok()??;
        let value = attribute.normalized_value(quick_xml::XmlVersion::Implicit1_0);
        Some(value.ok()?.into_owned())
    }

    pub(super) fn number(&self, name: &str) -> Option<i64> {
        self.text(name)?.trim().parse().ok()
    }

    /// Returns latitude and longitude, deg.
    pub(super) fn place(&self) -> Option<(f64, f64)> {
        let angle = |name| self.text(name)?.trim().parse().ok();
        Some((angle("lat")?, angle("lon")?))
    }
}

/// Passes each step to a function.
///
/// # Errors
/// Returns an error for what is no XML or is cut off, with its place, and the first error of the function.
pub(super) fn for_each_step(
    path: &Path,
    mut take: impl FnMut(Step<'_>) -> std::result::Result<(), String>,
) -> Result<()> {
    let file = unpacked::open(path, ROAD_ENDINGS)?;
    let file = decoded(file).map_err(Error::io(path))?;
    let budget = Budget::new(file, ELEMENT_BYTES, "part of XML");
    let mut reader = Reader::from_reader(BufReader::new(budget));
    let mut buffer = Vec::new();
    let mut depth = 0_usize;
    // A text comes in parts, with its entities between them.
    let mut text = String::new();
    loop {
        buffer.clear();
        reader.get_mut().get_mut().renew();
        let event = reader.read_event_into(&mut buffer);
        let at = reader.buffer_position();
        let wrong = |problem: String| {
            let problem = format!("byte {at}: {problem}; expected a whole XML file");
            Error::content(path, problem)
        };
        let failed = |problem: String| Error::content(path, problem);
        let event = event.map_err(|e| wrong(e.to_string()))?;
        if text.len() > ELEMENT_BYTES {
            return Err(wrong(format!("a text of more than {ELEMENT_BYTES} bytes")));
        }
        match &event {
            Event::Text(part) => text += &part.decode().map_err(|e| wrong(e.to_string()))?,
            Event::CData(part) => text += &part.decode().map_err(|e| wrong(e.to_string()))?,
            Event::GeneralRef(entity) => text += &entity_text(entity),
            Event::Start(_) | Event::Empty(_) | Event::End(_) if !text.is_empty() => {
                take(Step::Text(&text)).map_err(failed)?;
                text.clear();
            }
            _ => {}
        }
        match event {
            Event::Start(start) => {
                depth += 1;
                open(start, false, &mut take).map_err(failed)?;
            }
            Event::Empty(start) => open(start, true, &mut take).map_err(failed)?,
            Event::End(end) => {
                depth = depth.saturating_sub(1);
                let name = end.local_name();
                take(Step::Close(
                    str::from_utf8(name.as_ref()).unwrap_or_default(),
                ))
                .map_err(failed)?;
            }
            Event::Eof if depth > 0 => return Err(wrong("cut off".to_owned())),
            Event::Eof => return Ok(()),
            _ => {}
        }
    }
}

/// Returns the characters of an entity; itself, if it is not one of XML.
fn entity_text(entity: &BytesRef<'_>) -> String {
    if let Ok(Some(character)) = entity.resolve_char_ref() {
        return character.to_string();
    }
    let name = entity.decode().unwrap_or_default();
    match resolve_predefined_entity(&name) {
        Some(known) => known.to_owned(),
        None => format!("&{name};"),
    }
}

/// Returns the text as UTF-8. A byte order mark gives its encoding, otherwise the XML declaration.
fn decoded(mut file: Box<dyn Read>) -> std::io::Result<impl Read> {
    let mut head = Vec::new();
    file.by_ref()
        .take(DECLARATION_BYTES)
        .read_to_end(&mut head)?;
    let encoding = declared(&head).and_then(|label| Encoding::for_label(label.as_bytes()));
    let whole = std::io::Cursor::new(head).chain(file);
    // Damaged UTF-8 stays an error.
    let encoding = encoding.filter(|encoding| *encoding != UTF_8);
    let mut decoder = DecodeReaderBytesBuilder::new();
    Ok(decoder
        .encoding(encoding)
        .utf8_passthru(true)
        .bom_override(true)
        .strip_bom(true)
        .build(whole))
}

/// Returns the encoding that an XML declaration names, such as `ISO-8859-1`.
fn declared(head: &[u8]) -> Option<String> {
    let head = String::from_utf8_lossy(head);
    let declaration = head.trim_start_matches('\u{feff}').strip_prefix("<?xml")?;
    let (declaration, _) = declaration.split_once("?>")?;
    let (_, rest) = declaration.split_once("encoding")?;
    let rest = rest.trim_start().strip_prefix('=')?.trim_start();
    let quote = rest.chars().next().filter(|c| matches!(c, '"' | '\''))?;
    let (label, _) = rest.get(1..)?.split_once(quote)?;
    Some(label.to_owned())
}

fn open(
    start: BytesStart<'_>,
    is_empty: bool,
    take: &mut impl FnMut(Step<'_>) -> std::result::Result<(), String>,
) -> std::result::Result<(), String> {
    let name = start.local_name().as_ref().to_vec();
    let name = str::from_utf8(&name).unwrap_or_default();
    take(Step::Open(name, &Element(start)))?;
    if is_empty {
        take(Step::Close(name))?;
    }
    Ok(())
}
