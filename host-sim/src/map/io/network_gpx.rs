//! A network as the tracks and routes of a GPX file (<https://www.topografix.com/GPX/1/1/>).

use super::network_draft::{DraftWay, NetworkDraft, Position};
use super::xml_steps::{Step, for_each_step};
use crate::error::{Error, Result};
use crate::files::row_check;
use crate::map::geometry::way_name::WayDirection;
use std::path::Path;

/// A track or a route so far.
#[derive(Default)]
struct Track {
    name: Option<String>,
    parts: Vec<Vec<Position>>,
    problem: Option<String>,
    /// True within its own name, not within that of a point.
    is_in_name: bool,
    is_in_point: bool,
}

/// Reads the ways: each track or route is one, in both directions. Those without a name are numbered.
///
/// # Errors
/// Returns an error for a file that is no XML, or has no line.
pub(super) fn read(path: &Path) -> Result<NetworkDraft> {
    let mut draft = NetworkDraft::default();
    let mut track: Option<Track> = None;
    let mut count = 0_usize;
    for_each_step(path, |step| {
        match (step, &mut track) {
            (Step::Open("trk" | "rte", _), _) => {
                count += 1;
                track = Some(Track::default());
            }
            (Step::Open("trkseg", _), Some(track)) => track.parts.push(Vec::new()),
            (Step::Open("trkpt" | "rtept", element), Some(track)) => {
                track.is_in_point = true;
                track.add(element.place());
            }
            (Step::Close("trkpt" | "rtept"), Some(track)) => track.is_in_point = false,
            (Step::Open("name", _), Some(track)) => track.is_in_name = !track.is_in_point,
            (Step::Close("name"), Some(track)) => track.is_in_name = false,
            (Step::Text(text), Some(track)) if track.is_in_name => {
                track.name.get_or_insert_default().push_str(text.trim());
            }
            (Step::Close("trk" | "rte"), Some(_)) => {
                track.take().unwrap_or_default().end(count, &mut draft)?;
            }
            _ => {}
        }
        Ok(())
    })?;
    if count == 0 {
        return Err(Error::content(
            path,
            "no track and no route; expected at least one",
        ));
    }
    Ok(draft)
}

impl Track {
    fn add(&mut self, place: Option<Position>) {
        if self.parts.is_empty() {
            self.parts.push(Vec::new());
        }
        let place = place.ok_or_else(|| "a point without lat and lon".to_owned());
        let checked = place.and_then(|(latitude_deg, longitude_deg)| {
            row_check::position(latitude_deg, longitude_deg)
                .map(|()| (latitude_deg, longitude_deg))
                .map_err(|flaw| format!("{}; expected {}", flaw.problem, flaw.expected))
        });
        match (checked, self.parts.last_mut()) {
            (Ok(place), Some(part)) => part.push(place),
            (Err(problem), _) => {
                self.problem.get_or_insert(problem);
            }
            _ => {}
        }
    }

    fn end(self, number: usize, draft: &mut NetworkDraft) -> std::result::Result<(), String> {
        let name = self.name.filter(|name| !name.is_empty());
        let name = name.unwrap_or_else(|| format!("track {number}"));
        let place = format!("track {number}, {name}");
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
