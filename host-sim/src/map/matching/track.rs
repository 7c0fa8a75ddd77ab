//! The track of a run, as points to match and as a road for other runs.

use super::track_point::TrackPoint;
use crate::files::run::RunCell;
use crate::map::geometry::plane::chord_m;
use crate::map::geometry::road_line::RoadPoint;
use crate::numeric::local_fit;

/// Half width over which the track is smoothed, m. The fit is quadratic: it follows bends of
/// 50 m radius within half a metre, and reduces position noise as much as a mean over ±30 m.
const TRACK_REACH_M: f64 = 60.0;
/// Minimum distance between points, m; a receiver at standstill gives no more.
const STANDSTILL_M: f64 = 0.5;

/// Returns the track of a run.
pub fn track_of_run<R>(rows: &[R]) -> Vec<TrackPoint>
where
    RunCell: for<'a> From<&'a R>,
{
    rows.iter()
        .map(RunCell::from)
        .map(|cell| TrackPoint {
            odometer_m: cell.distance_m,
            position: cell.position,
        })
        .collect()
}

/// Returns the road of a run: its smoothed track, from the first position to the last. Distances
/// are lengths of the track from its start. Over cells without a position the track is a straight
/// line, and distances are those of the odometer. `None` with fewer than two positions.
pub fn road_of_run<R>(rows: &[R]) -> Option<Vec<RoadPoint>>
where
    RunCell: for<'a> From<&'a R>,
{
    let rows: Vec<RunCell> = rows.iter().map(RunCell::from).collect();
    let fixes: Vec<(usize, f64, f64)> = rows
        .iter()
        .enumerate()
        .filter_map(|(i, row)| {
            row.position
                .map(|(latitude_deg, longitude_deg)| (i, latitude_deg, longitude_deg))
        })
        .collect();
    let odometer_m: Vec<f64> = fixes.iter().map(|fix| rows[fix.0].distance_m).collect();
    // Relative to the first position, so that a road across the date line stays continuous.
    let first = *fixes.first()?;
    let latitude: Vec<f64> = fixes.iter().map(|fix| fix.1 - first.1).collect();
    let longitude: Vec<f64> = fixes
        .iter()
        .map(|fix| (fix.2 - first.2 + 180.0).rem_euclid(360.0) - 180.0)
        .collect();
    let latitude = local_fit::smooth::<3>(&odometer_m, &latitude, TRACK_REACH_M);
    let longitude = local_fit::smooth::<3>(&odometer_m, &longitude, TRACK_REACH_M);

    let mut road: Vec<RoadPoint> = Vec::with_capacity(fixes.len());
    let mut last: Option<(usize, (f64, f64, f64))> = None;
    let mut distance_m = 0.0;
    let altitude = |row: &RunCell| row.altitude.map(|(altitude_m, _)| altitude_m);
    // An unknown altitude stays as it was: an invented step would lengthen the road.
    let mut altitude_m = rows.iter().find_map(altitude).unwrap_or(0.0);
    for (fix, (latitude, longitude)) in fixes.iter().zip(latitude.iter().zip(&longitude)) {
        altitude_m = altitude(&rows[fix.0]).unwrap_or(altitude_m);
        let place = (
            first.1 + latitude,
            (first.2 + longitude + 180.0).rem_euclid(360.0) - 180.0,
            altitude_m,
        );
        if let Some((i, before)) = last {
            let chord_m = chord_m(before, place);
            if chord_m < STANDSTILL_M {
                continue;
            }
            let bridged = fix.0 > i + 1;
            let driven_m = rows[fix.0].distance_m - rows[i].distance_m;
            distance_m += if bridged { driven_m } else { chord_m };
        }
        last = Some((fix.0, place));
        road.push(RoadPoint {
            distance_m,
            latitude_deg: place.0,
            longitude_deg: place.1,
        });
    }
    (road.len() >= 2).then_some(road)
}
