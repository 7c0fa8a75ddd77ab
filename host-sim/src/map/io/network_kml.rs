//! A network as the lines of a KML file (OGC 12-007r2).

use super::network_draft::{NetworkDraft, Position, position};
use super::network_track::DraftTrack;
use super::xml_steps::{Step, for_each_step};
use crate::error::{Error, Result};
use std::path::Path;

/// A placemark so far.
#[derive(Default)]
struct Placemark {
    draft: DraftTrack,
    /// Elements that are open within it.
    open: Vec<String>,
    /// Text of the innermost element.
    text: String,
}

/// Reads the ways: each placemark with lines is one, in both directions. Those without a name are
/// numbered.
///
/// # Errors
/// Returns an error for a file that is no XML, or has no placemark.
pub(super) fn read(path: &Path) -> Result<NetworkDraft> {
    let mut draft = NetworkDraft::default();
    let mut placemark: Option<Placemark> = None;
    let mut count = 0_usize;
    for_each_step(path, |step| {
        match (step, &mut placemark) {
            (Step::Open("Placemark", _), _) => {
                count += 1;
                placemark = Some(Placemark::default());
            }
            (Step::Close("Placemark"), Some(_)) => {
                let whole = placemark.take().unwrap_or_default();
                whole.draft.end("placemark", count, &mut draft)?;
            }
            (Step::Open(name, _), Some(placemark)) => {
                placemark.open.push(name.to_owned());
                placemark.text.clear();
                if name == "Track" {
                    placemark.draft.begin_part();
                }
            }
            (Step::Text(text), Some(placemark)) => placemark.text.push_str(text),
            (Step::Close(name), Some(placemark)) => placemark.close(name),
            _ => {}
        }
        Ok(())
    })?;
    if count == 0 {
        return Err(Error::content(
            path,
            "no placemark; expected some with a LineString",
        ));
    }
    Ok(draft)
}

impl Placemark {
    fn close(&mut self, name: &str) {
        self.open.pop();
        let within = self.open.last().map(String::as_str);
        let text = std::mem::take(&mut self.text);
        match (name, within) {
            ("name", None) => text.trim().clone_into(&mut self.draft.name),
            ("coordinates", Some("LineString")) => {
                self.draft.begin_part();
                for words in text.split_whitespace() {
                    self.draft.add(point(words, ','));
                }
            }
            ("coord", Some("Track")) => self.draft.add(point(text.trim(), ' ')),
            _ => {}
        }
    }
}

/// Reads longitude and latitude, and perhaps an altitude.
fn point(text: &str, mark: char) -> std::result::Result<Position, String> {
    let mut words = text.split(mark).map(|word| word.trim().parse::<f64>().ok());
    let (Some(Some(longitude_deg)), Some(Some(latitude_deg))) = (words.next(), words.next()) else {
        return Err(format!("`{}` is no position", text.escape_debug()));
    };
    position(latitude_deg, longitude_deg)
}
