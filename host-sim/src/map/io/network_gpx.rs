//! A network as the tracks and routes of a GPX file (<https://www.topografix.com/GPX/1/1/>).

use super::network_draft::{NetworkDraft, position};
use super::network_track::DraftTrack;
use super::xml_steps::{Step, for_each_step};
use crate::error::{Error, Result};
use std::path::Path;

/// A track or a route so far.
#[derive(Default)]
struct Track {
    draft: DraftTrack,
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
            (Step::Open("trkseg", _), Some(track)) => track.draft.begin_part(),
            (Step::Open("trkpt" | "rtept", element), Some(track)) => {
                track.is_in_point = true;
                let place = element.place();
                let place = place.ok_or_else(|| "no lat and lon".to_owned());
                let place = place.and_then(|(latitude, longitude)| position(latitude, longitude));
                track.draft.add(place);
            }
            (Step::Close("trkpt" | "rtept"), Some(track)) => track.is_in_point = false,
            (Step::Open("name", _), Some(track)) => track.is_in_name = !track.is_in_point,
            (Step::Close("name"), Some(track)) => track.is_in_name = false,
            (Step::Text(text), Some(track)) if track.is_in_name => {
                track.draft.name.push_str(text.trim());
            }
            (Step::Close("trk" | "rte"), Some(_)) => {
                let whole = track.take().unwrap_or_default();
                whole.draft.end("track", count, &mut draft)?;
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
