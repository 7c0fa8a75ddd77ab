//! The elements of an XML file, one after the other.

use crate::error::{Error, Result};
use crate::files::limits::Budget;
use crate::files::unpacked::{self, ROAD_ENDINGS};
use quick_xml::Reader;
use quick_xml::events::{BytesStart, Event};
use std::io::BufReader;
use std::path::Path;

/// Bytes of one element or text: a line of 2,500 km.
const ELEMENT_BYTES: usize = 8 << 20;

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
    let budget = Budget::new(file, ELEMENT_BYTES, "part of XML");
    let mut reader = Reader::from_reader(BufReader::new(budget));
    let mut buffer = Vec::new();
    let mut depth = 0_usize;
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
        match event.map_err(|e| wrong(e.to_string()))? {
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
            Event::Text(text) => {
                let text = text.decode().map_err(|e| wrong(e.to_string()))?;
                take(Step::Text(&text)).map_err(failed)?;
            }
            Event::CData(text) => {
                let text = text.decode().map_err(|e| wrong(e.to_string()))?;
                take(Step::Text(&text)).map_err(failed)?;
            }
            Event::Eof if depth > 0 => return Err(wrong("cut off".to_owned())),
            Event::Eof => return Ok(()),
            _ => {}
        }
    }
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
