//! Plans: lines seen from above, north up, coloured by a value.

use super::chart_data::{Drawn, number};
pub use super::colouring::Colouring;
use serde_json::{Value, json};

/// Length of a degree of latitude, m.
const DEGREE_M: f64 = 111_200.0;
/// Largest number of drawn points of a plan.
const MOST_POINTS: usize = 12_000;

/// A point of a line.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PlanPoint {
    /// Latitude, deg.
    pub latitude_deg: f64,
    /// Longitude, deg.
    pub longitude_deg: f64,
    /// Distance along the line, m.
    pub distance_m: f64,
    /// A value for each [`Colouring`] of the plan.
    pub values: Vec<f64>,
}

/// A line in its direction of travel.
#[derive(Clone, Debug, Default)]
pub struct PlanLine {
    /// Name that hover shows; may be empty.
    pub name: String,
    /// Name that it shares with the profiles along it ([`Plot::link`](super::plot::Plot::link)).
    pub link: String,
    /// Its points.
    pub points: Vec<PlanPoint>,
}

/// A plan.
#[derive(Clone, Debug, Default)]
pub struct Plan {
    /// Ways to colour it; the reader chooses, the first one is shown.
    pub colourings: Vec<Colouring>,
    /// Lines.
    pub lines: Vec<PlanLine>,
}

impl Plan {
    /// Returns the plan for the page's script: metres east and north of the middle.
    pub(super) fn drawn(&self) -> Drawn {
        let points = || self.lines.iter().flat_map(|line| &line.points);
        let reference_deg = points().next().map_or(0.0, |point| point.longitude_deg);
        // Longitudes are relative to one point, so a line across the date line stays continuous.
        let turn = |longitude: f64| (longitude - reference_deg + 540.0).rem_euclid(360.0) - 180.0;
        let middle_deg = middle(points().map(|point| point.latitude_deg));
        let centre_deg = middle(points().map(|point| turn(point.longitude_deg)));
        let east_m = DEGREE_M * middle_deg.to_radians().cos();
        let group = points().count().div_ceil(MOST_POINTS).max(1);
        let place = |point: &PlanPoint| {
            [
                decimetres((turn(point.longitude_deg) - centre_deg) * east_m),
                decimetres((point.latitude_deg - middle_deg) * DEGREE_M),
            ]
        };
        let lines: Vec<Value> = self
            .lines
            .iter()
            .map(|line| line.json(group, &place))
            .collect();
        let words = if group > 1 {
            format!("Each drawn point is the mean of {group} cells.")
        } else {
            String::new()
        };
        let value = json!({
            "kind": "plan",
            "middle": [middle_deg, centre_deg + reference_deg],
            "metres": [DEGREE_M, number(east_m)],
            "colourings": self.colourings.iter().map(Colouring::json).collect::<Vec<_>>(),
            "lines": lines,
        });
        Drawn::new(&value, words)
    }
}

impl PlanLine {
    fn json(&self, group: usize, place: &dyn Fn(&PlanPoint) -> [f64; 2]) -> Value {
        let groups: Vec<&[PlanPoint]> = self.points.chunks(group).collect();
        let last = self.points.last().filter(|_| group > 1);
        let firsts = groups.iter().map(|group| &group[0]).chain(last);
        let firsts: Vec<&PlanPoint> = firsts.collect();
        let kinds = self.points.first().map_or(0, |point| point.values.len());
        let mean = |kind: usize| {
            let means = groups.iter().map(move |group| {
                let sum: f64 = group.iter().map(|point| point.values[kind]).sum();
                number(round_to(sum / group.len() as f64, 1e4))
            });
            means.collect::<Vec<_>>()
        };
        json!({
            "name": self.name,
            "link": self.link,
            "places": firsts.iter().flat_map(|point| place(point)).collect::<Vec<_>>(),
            "km": firsts.iter().map(|point| number(point.distance_m * 1e-3)).collect::<Vec<_>>(),
            "values": (0..kinds).map(mean).collect::<Vec<_>>(),
        })
    }
}

fn middle(values: impl Iterator<Item = f64>) -> f64 {
    let none = (f64::INFINITY, f64::NEG_INFINITY);
    let (low, high) = values.fold(none, |(low, high), value| (low.min(value), high.max(value)));
    if low > high { 0.0 } else { 0.5 * (low + high) }
}

fn decimetres(metres: f64) -> f64 {
    round_to(metres, 10.0)
}

fn round_to(value: f64, per_unit: f64) -> f64 {
    (value * per_unit).round() / per_unit
}
