//! A spatial index of the segments of ways.

use super::plane::earth_centred;
use super::road_line::{LATERAL_LIMIT_M, RoadLine};
use rstar::primitives::{GeomWithData, Rectangle};
use rstar::{AABB, RTree, RTreeObject};
use std::ops::Range;

/// Number of segments per entry of the index. With a point every 2.5 m, twenty segments are near a
/// position. Checking a few more is faster than a query for each.
const PIECE: usize = 8;
/// Largest length of several segments in one entry, m. A box around eight longer segments would
/// contain much that is not near.
const PIECE_M: f64 = 100.0;
/// Distance of positions from the last query before the index is queried again, m.
const SURROUNDINGS_M: f64 = 100.0;
/// Radius of the Earth, m.
const RADIUS_M: f64 = 6.37e6;

/// A box with its way and segments.
type BoxedPiece = GeomWithData<Rectangle<[f64; 3]>, (usize, Range<usize>)>;

/// Boxes around parts of ways in earth-centred coordinates; the size of a network is not limited.
#[derive(Debug)]
pub(crate) struct RoadIndex {
    pieces: RTree<BoxedPiece>,
}

/// The segments around a place, cached for the next positions.
#[derive(Debug, Default)]
pub(crate) struct Surroundings {
    centre: Option<[f64; 3]>,
    pieces: Vec<WaySegments>,
}

/// A range of segments of one way.
#[derive(Debug)]
pub(crate) struct WaySegments {
    pub way: usize,
    pub segments: Range<usize>,
    around: AABB<[f64; 3]>,
}

impl RoadIndex {
    /// Creates the index of these ways.
    pub(crate) fn of<'a>(ways: impl Iterator<Item = &'a RoadLine>) -> Self {
        let mut pieces = Vec::new();
        for (way, line) in ways.enumerate() {
            let points = line.points();
            let places: Vec<[f64; 3]> = points
                .iter()
                .map(|point| earth_centred(point.latitude_deg, point.longitude_deg))
                .collect();
            let mut first = 0;
            while first + 1 < points.len() {
                let limit_m = points[first].distance_m + PIECE_M;
                let end = (first + 2..points.len().min(first + PIECE + 1))
                    .take_while(|&end| points[end].distance_m <= limit_m)
                    .last()
                    .unwrap_or(first + 1);
                let around = around(&places[first..=end]);
                pieces.push(GeomWithData::new(
                    Rectangle::from_aabb(around),
                    (way, first..end),
                ));
                first = end;
            }
        }
        Self {
            pieces: RTree::bulk_load(pieces),
        }
    }

    /// Returns the segments that may be within reach of a place, in the order of ways and
    /// distances. `surroundings` is the cache of an earlier place on the same network, or none.
    pub(crate) fn near<'s>(
        &self,
        surroundings: &'s mut Surroundings,
        place_m: [f64; 3],
    ) -> impl Iterator<Item = &'s WaySegments> + use<'s> {
        if !surroundings.hold(place_m) {
            *surroundings = self.surroundings(place_m);
        }
        surroundings.pieces.iter().filter(move |piece| {
            piece.around.distance_2(&place_m) <= LATERAL_LIMIT_M * LATERAL_LIMIT_M
        })
    }

    fn surroundings(&self, centre: [f64; 3]) -> Surroundings {
        let reach = LATERAL_LIMIT_M + SURROUNDINGS_M;
        let around = AABB::from_corners(centre.map(|x| x - reach), centre.map(|x| x + reach));
        let mut pieces: Vec<WaySegments> = self
            .pieces
            .locate_in_envelope_intersecting(around)
            .map(|piece| WaySegments {
                way: piece.data.0,
                segments: piece.data.1.clone(),
                around: piece.geom().envelope(),
            })
            .collect();
        // The index returns its entries in no fixed order.
        pieces.sort_unstable_by_key(|piece| (piece.way, piece.segments.start));
        Surroundings {
            centre: Some(centre),
            pieces,
        }
    }
}

/// Returns a box around points and the lines between them on the ground: a chord of the Earth is
/// below the ground by its length squared over eight radii.
fn around(places: &[[f64; 3]]) -> AABB<[f64; 3]> {
    let boxed = AABB::from_points(places);
    let (lower, upper) = (boxed.lower(), boxed.upper());
    let squared: f64 = (0..3).map(|i| (upper[i] - lower[i]).powi(2)).sum();
    let sag_m = squared / (8.0 * RADIUS_M);
    AABB::from_corners(lower.map(|x| x - sag_m), upper.map(|x| x + sag_m))
}

impl Surroundings {
    /// Returns true if the cache contains all segments within reach of a place.
    fn hold(&self, place_m: [f64; 3]) -> bool {
        self.centre
            .is_some_and(|centre| (0..3).all(|i| (place_m[i] - centre[i]).abs() <= SURROUNDINGS_M))
    }
}
