//! The network around the fleet's road: 10 lines (14 ways) a kilometre.

use super::FleetSpot;
use serde_json::{Value, json};

/// Spots of a piece of the road: 500 m.
const PIECE: usize = 200;
/// Spots from point to point of a line: 20 m.
const EVERY: usize = 8;
/// Metres of a degree of latitude.
const DEGREE_M: f64 = 111_195.0;

/// Returns the network as GeoJSON: for each 500 m of the road a piece of it, one of the opposite
/// carriageway 15 m to the left, one of a street 20 m to the right, a street that crosses, and a
/// bridge.
pub fn geojson(road: &[FleetSpot]) -> Value {
    let starts = (0..road.len() - 1).step_by(PIECE);
    let lines = starts.enumerate().flat_map(|(number, first)| {
        let last = (first + PIECE).min(road.len() - 1);
        let places: Vec<usize> = (first..last).step_by(EVERY).chain([last]).collect();
        let along = |right_m: f64| places.iter().map(move |&i| beside(road, i, right_m));
        let mut back: Vec<[f64; 2]> = along(-15.0).collect();
        back.reverse();
        let across = |i: usize, turn: f64| {
            let ends = [-300.0, 300.0].map(|m| moved(road, i, turn, m));
            vec![ends[0], beside(road, i, 0.0), ends[1]]
        };
        [
            line("road", number, "yes", &along(0.0).collect::<Vec<_>>()),
            line("back", number, "yes", &back),
            line("street", number, "no", &along(20.0).collect::<Vec<_>>()),
            line("crossing", number, "no", &across(first, 90.0)),
            // Between points of the road: it shares none.
            line(
                "bridge",
                number,
                "yes",
                &across((first + last) / 2 + 3, 60.0),
            ),
        ]
    });
    json!({"type": "FeatureCollection", "features": lines.collect::<Vec<_>>()})
}

fn line(kind: &str, number: usize, oneway: &str, points: &[[f64; 2]]) -> Value {
    json!({
        "type": "Feature",
        "properties": {"way": format!("{kind} {number:04}"), "oneway": oneway},
        "geometry": {"type": "LineString", "coordinates": points},
    })
}

/// Returns longitude and latitude beside a spot.
fn beside(road: &[FleetSpot], i: usize, right_m: f64) -> [f64; 2] {
    moved(road, i, 90.0, right_m)
}

/// Returns longitude and latitude of a place this far from a spot, at an angle to the road.
fn moved(road: &[FleetSpot], i: usize, turn_deg: f64, by_m: f64) -> [f64; 2] {
    let (a, b) = (
        &road[i.saturating_sub(1)],
        &road[(i + 1).min(road.len() - 1)],
    );
    let shrink = road[i].latitude_deg.to_radians().cos();
    let (north, east) = (
        b.latitude_deg - a.latitude_deg,
        (b.longitude_deg - a.longitude_deg) * shrink,
    );
    let course = east.atan2(north) + turn_deg.to_radians();
    let step_deg = by_m / DEGREE_M;
    [
        road[i].longitude_deg + step_deg * course.sin() / shrink,
        road[i].latitude_deg + step_deg * course.cos(),
    ]
}
