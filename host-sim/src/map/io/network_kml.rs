//! A network as the lines of a KML file (OGC 12-007r2).

use super::network_draft::{DraftWay, NetworkDraft, Position};
use super::xml_steps::{Step, for_each_step};
use crate::error::{Error, Result};
use crate::files::row_check;
use crate::map::geometry::way_name::WayDirection;
use std::path::Path;

/// A placemark so far.
#[derive(Default)]
struct Placemark {
    name: String,
    parts: Vec<Vec<Position>>,
    problem: Option<String>,
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
                placemark
                    .take()
                    .unwrap_or_default()
                    .end(count, &mut draft)?;
            }
            (Step::Open(name, _), Some(placemark)) => {
                placemark.open.push(name.to_owned());
                placemark.text.clear();
                if name == "Track" {
                    placemark.parts.push(Vec::new());
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
            ("name", None) => text.trim().clone_into(&mut self.name),
            ("coordinates", Some("LineString")) => {
                let points = text.split_whitespace().map(|words| point(words, ','));
                match points.collect() {
                    Ok(points) => self.parts.push(points),
                    Err(problem) => {
                        self.problem.get_or_insert(problem);
                    }
                }
            }
            ("coord", Some("Track")) => match (point(text.trim(), ' '), self.parts.last_mut()) {
                (Ok(point), Some(part)) => part.push(point),
                (Err(problem), _) => {
                    self.problem.get_or_insert(problem);
                }
                _ => {}
            },
            _ => {}
        }
    }

    fn end(self, number: usize, draft: &mut NetworkDraft) -> std::result::Result<(), String> {
        let name = match &*self.name {
            "" => format!("placemark {number}"),
            name => name.to_owned(),
        };
        let place = format!("placemark {number}, {name}");
        if let Some(problem) = self.problem {
            draft.leave_out(format!("{place}: {problem}"));
            return Ok(());
        }
        let way = DraftWay {
            name,
            parts: self.parts,
            directions: vec![WayDirection::Forward, WayDirection::Backward],
            structure: None,
        };
        draft.add(&place, way)
    }
}

/// Reads longitude and latitude, and perhaps an altitude.
fn point(text: &str, mark: char) -> std::result::Result<Position, String> {
    let mut words = text.split(mark).map(|word| word.trim().parse::<f64>().ok());
    let (Some(Some(longitude_deg)), Some(Some(latitude_deg))) = (words.next(), words.next()) else {
        return Err(format!("`{}` is no position", text.escape_debug()));
    };
    row_check::position(latitude_deg, longitude_deg)
        .map_err(|flaw| format!("{}; expected {}", flaw.problem, flaw.expected))?;
    Ok((latitude_deg, longitude_deg))
}
