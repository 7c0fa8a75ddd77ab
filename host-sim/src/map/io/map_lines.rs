//! The lines of a map for drawing.

use super::map_geojson::{pieces, segments};
use crate::map::fusion::map_row::{MapRow, WayRows};

/// A line: neighbouring cells of one way.
#[derive(Clone, Debug)]
pub(super) struct Line<'r> {
    /// Name of the way.
    pub(super) name: String,
    /// Its cells, at least one.
    pub(super) rows: &'r [MapRow],
}

/// Returns the segments of all ways without gaps, or their pieces of this length, m.
pub(super) fn lines(ways: &[WayRows], piece_m: Option<f64>) -> impl Iterator<Item = Line<'_>> {
    ways.iter().flat_map(move |way| {
        let name = way
            .name
            .as_ref()
            .map_or_else(|| "road".to_owned(), ToString::to_string);
        let of_segment = move |segment| -> Vec<&[MapRow]> {
            match piece_m {
                None => vec![segment],
                Some(piece_m) => pieces(segment, piece_m).collect(),
            }
        };
        segments(&way.rows)
            .flat_map(of_segment)
            .map(move |rows| Line {
                name: name.clone(),
                rows,
            })
    })
}
