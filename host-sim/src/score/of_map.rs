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
    let at = map.iter().map(|row| linear(reference, row.distance_m));
    score_true(map, &at.collect::<Vec<_>>())
}

/// Compares a map with a reference road that has grades, by position and course. Their distances
/// may start at different points.
///
/// # Errors
/// Returns an error if the reference is no road or has no grade, or if no cell is left to compare.
pub fn score_map_on_road(map: &[MapRow], reference: &[RoadRow]) -> Result<ScoreRow, Unscorable> {
    score_true(map, &true_grades(map, reference)?)
}

/// Returns the true grade at each cell of a map, %: that of a reference road where the cell lies on
/// it by position and course. `None` beyond the road.
///
/// # Errors
/// Returns an error if the reference is no road or has no grade.
pub fn true_grades(map: &[MapRow], reference: &[RoadRow]) -> Result<Vec<Option<f64>>, Unscorable> {
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
    Ok(match_track(&road, &track)
        .into_iter()
        .map(|place| match place {
            MatchedPlace::OnRoad { distance_m, .. } => linear(&grades, distance_m),
            _ => None,
        })
        .collect())
}

fn score_true(map: &[MapRow], true_percent: &[Option<f64>]) -> Result<ScoreRow, Unscorable> {
    let mut sums = Sums::default();
    for (row, true_percent) in map.iter().zip(true_percent) {
        let ends = (map[0].distance_m, map[map.len() - 1].distance_m);
        if is_end(ends.0, ends.1, row.distance_m) {
            continue;
        }
        if let Some(true_percent) = true_percent {
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
