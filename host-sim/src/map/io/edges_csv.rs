//! EDGES.csv: the slopes of the edges of a network.

use crate::error::Result;
use crate::files::csv::stage_csv;
use crate::files::output::Staged;
use crate::map::geometry::structure::Structure;
use crate::map::slopes::edges::{Edge, Slopes};
use crate::numeric::rounding::round;
use serde::Serialize;
use std::path::Path;

#[derive(Serialize)]
struct Row {
    way: String,
    direction: &'static str,
    from_m: f64,
    to_m: f64,
    length_m: f64,
    from_latitude_deg: f64,
    from_longitude_deg: f64,
    to_latitude_deg: f64,
    to_longitude_deg: f64,
    structure: Option<&'static str>,
    covered_percent: f64,
    average_grade_percent: Option<f64>,
    largest_up_percent: Option<f64>,
    largest_down_percent: Option<f64>,
    grade_sigma_percent: Option<f64>,
    runs: u32,
    from_other_direction: u8,
}

/// Writes edges to a file that appears when it is committed.
///
/// # Errors
/// Returns the error of the file system.
pub fn stage(path: &Path, edges: &[Edge<'_>]) -> Result<Staged> {
    stage_csv(path, edges.iter().map(row))
}

fn row(edge: &Edge<'_>) -> Row {
    let slopes = edge.slopes.as_ref();
    let number = |value: fn(&Slopes) -> f64| slopes.map(|slopes| round(value(slopes), 3));
    let [from, to] = edge.ends_deg;
    Row {
        way: edge.way.unwrap_or_default().to_owned(),
        direction: edge.direction.word(),
        from_m: round(edge.range_m.start, 2),
        to_m: round(edge.range_m.end, 2),
        length_m: round(edge.range_m.end - edge.range_m.start, 2),
        from_latitude_deg: round(from.0, 7),
        from_longitude_deg: round(from.1, 7),
        to_latitude_deg: round(to.0, 7),
        to_longitude_deg: round(to.1, 7),
        structure: edge.structure.map(Structure::word),
        covered_percent: slopes.map_or(0.0, |s| round(100.0 * s.mean.covered, 1)),
        average_grade_percent: number(|s| s.mean.grade_percent),
        largest_up_percent: number(|s| s.largest_up_percent),
        largest_down_percent: number(|s| s.largest_down_percent),
        grade_sigma_percent: number(|s| s.mean.sigma_percent),
        runs: slopes.map_or(0, |s| s.mean.runs),
        from_other_direction: u8::from(slopes.is_some_and(|s| s.from_other_direction)),
    }
}
