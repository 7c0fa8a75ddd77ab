//! A map against a reference.

use super::score_row::{ScoreRow, Sums, Unscorable, is_end};
use crate::map::{MapRow, MatchedPlace, Network, RoadLine, RoadRow, TrackPoint, match_track};
use crate::numeric::series::linear;

/// Compares a map with a reference by distance. The reference is sorted pairs of distance (m) and
/// grade (%). Both distances must start at the same point.
///
/// # Errors
/// Returns an error if no cell is left to compare.
pub fn score_map(map: &[MapRow], reference: &[(f64, f64)]) -> Result<ScoreRow, Unscorable> {
    let places: Vec<Option<f64>> = map.iter().map(|row| Some(row.distance_m)).collect();
    score_placed(map, &places, reference)
}

/// Compares a map with a reference road that has grades, by position and course. Their distances
/// may start at different points.
///
/// # Errors
/// Returns an error if the reference is no road or has no grade, or if no cell is left to compare.
pub fn score_map_on_road(map: &[MapRow], reference: &[RoadRow]) -> Result<ScoreRow, Unscorable> {
    let road = Network::from(RoadLine::new(
        reference.iter().map(RoadRow::point).collect(),
    )?);
    let grades: Vec<(f64, f64)> = reference
        .iter()
        .filter_map(|row| Some((row.distance_m, row.grade_percent?)))
        .collect();
    if grades.is_empty() {
        return Err(Unscorable::NoGrade);
    }
    let track: Vec<TrackPoint> = map
        .iter()
        .map(|row| TrackPoint {
            odometer_m: row.distance_m,
            position: Some((row.latitude_deg, row.longitude_deg)),
        })
        .collect();
    let places: Vec<Option<f64>> = match_track(&road, &track)
        .into_iter()
        .map(|place| match place {
            MatchedPlace::OnRoad { distance_m, .. } => Some(distance_m),
            _ => None,
        })
        .collect();
    score_placed(map, &places, &grades)
}

fn score_placed(
    map: &[MapRow],
    places: &[Option<f64>],
    reference: &[(f64, f64)],
) -> Result<ScoreRow, Unscorable> {
    let mut sums = Sums::default();
    for (row, place) in map.iter().zip(places) {
        let ends = (map[0].distance_m, map[map.len() - 1].distance_m);
        if is_end(ends.0, ends.1, row.distance_m) {
            continue;
        }
        if let Some(true_percent) = place.and_then(|at| linear(reference, at)) {
            sums.add(
                row.grade_percent - true_percent,
                row.grade_sigma_percent,
                true,
                None,
            );
        }
    }
    sums.row("map", "map")
        .ok_or(Unscorable::NothingLeft { cells: map.len() })
}
