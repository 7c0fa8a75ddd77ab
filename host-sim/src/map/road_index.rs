//! Which segments of a road lie near a position.

use super::road_line::LATERAL_LIMIT_M;
use rstar::primitives::{GeomWithData, Rectangle};
use rstar::{AABB, RTree, RTreeObject};

/// Segments of one entry of the index: at a point every 2.5 m there are twenty near a position,
/// and asking for each by itself takes longer than looking at a few more.
const PIECE: usize = 8;
/// How far positions may go before the index is asked again, m.
const SURROUNDINGS_M: f64 = 50.0;

/// Boxes around pieces of a road, each with the number of its first segment.
#[derive(Debug)]
pub(super) struct RoadIndex {
    pieces: RTree<GeomWithData<Rectangle<[f64; 2]>, usize>>,
    segments: usize,
}

/// Pieces of a road around a place: those that the next positions need too.
#[derive(Debug, Default)]
pub(super) struct Surroundings {
    centre: Option<[f64; 2]>,
    pieces: Vec<Piece>,
}

#[derive(Debug)]
struct Piece {
    first: usize,
    end: usize,
    around: AABB<[f64; 2]>,
}

impl RoadIndex {
    /// Of a road through these points of a plane, two or more.
    pub(super) fn of(plan: &[[f64; 2]]) -> Self {
        let segments = plan.len() - 1;
        let piece = |first: usize| {
            let points = &plan[first..=(first + PIECE).min(segments)];
            GeomWithData::new(Rectangle::from_aabb(AABB::from_points(points)), first)
        };
        Self {
            pieces: RTree::bulk_load((0..segments).step_by(PIECE).map(piece).collect()),
            segments,
        }
    }

    /// Segments that may lie within reach of a point, in the road's order. `surroundings` are
    /// those of an earlier point of the same road, or none.
    pub(super) fn near<'s>(
        &self,
        surroundings: &'s mut Surroundings,
        point: [f64; 2],
    ) -> impl Iterator<Item = usize> + use<'s> {
        if !surroundings.hold(point) {
            *surroundings = self.surroundings(point);
        }
        surroundings
            .pieces
            .iter()
            .filter(move |piece| {
                piece.around.distance_2(&point) <= LATERAL_LIMIT_M * LATERAL_LIMIT_M
            })
            .flat_map(|piece| piece.first..piece.end)
    }

    fn surroundings(&self, centre: [f64; 2]) -> Surroundings {
        let reach = LATERAL_LIMIT_M + SURROUNDINGS_M;
        let around = AABB::from_corners(
            [centre[0] - reach, centre[1] - reach],
            [centre[0] + reach, centre[1] + reach],
        );
        let mut pieces: Vec<Piece> = self
            .pieces
            .locate_in_envelope_intersecting(around)
            .map(|piece| Piece {
                first: piece.data,
                end: (piece.data + PIECE).min(self.segments),
                around: piece.geom().envelope(),
            })
            .collect();
        // The index answers in its own order.
        pieces.sort_unstable_by_key(|piece| piece.first);
        Surroundings {
            centre: Some(centre),
            pieces,
        }
    }
}

impl Surroundings {
    /// Whether everything within reach of a point is among them.
    fn hold(&self, point: [f64; 2]) -> bool {
        self.centre.is_some_and(|centre| {
            (point[0] - centre[0]).abs() <= SURROUNDINGS_M
                && (point[1] - centre[1]).abs() <= SURROUNDINGS_M
        })
    }
}
