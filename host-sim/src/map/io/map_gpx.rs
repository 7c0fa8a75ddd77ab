//! Maps as GPX 1.1 (<https://www.topografix.com/GPX/1/1/>): a track for each way, with altitudes.

use super::map_lines::lines;
use crate::error::Result;
use crate::files::output::{Staged, stage as stage_file};
use crate::map::fusion::map_row::{MapRow, WayRows};
use gpx::{Gpx, GpxVersion, Track, TrackSegment, Waypoint};
use std::io;
use std::path::Path;

/// Writes a map to a file that appears when it is committed. Each segment of a way without a gap is
/// a segment of its track. GPX has no grades: it is for devices that show a profile of altitude.
///
/// # Errors
/// Returns the error of the file system.
pub fn stage(path: &Path, ways: &[WayRows]) -> Result<Staged> {
    let mut tracks: Vec<Track> = Vec::new();
    for line in lines(ways, None) {
        let mut segment = TrackSegment::new();
        segment.points = line.rows.iter().map(waypoint).collect();
        match tracks.last_mut() {
            Some(track) if track.name.as_deref() == Some(&*line.name) => {
                track.segments.push(segment);
            }
            _ => {
                let mut track = Track::new();
                track.name = Some(line.name);
                track.segments.push(segment);
                tracks.push(track);
            }
        }
    }
    let content = Gpx {
        version: GpxVersion::Gpx11,
        creator: Some("roadgrade".to_owned()),
        tracks,
        ..Gpx::default()
    };
    stage_file(path, |out| {
        gpx::write(&content, out).map_err(io::Error::other)
    })
}

fn waypoint(row: &MapRow) -> Waypoint {
    let mut point = Waypoint::new((row.longitude_deg, row.latitude_deg).into());
    point.elevation = row.altitude_m;
    point
}
