//! Limits of a network, so that a damaged file does not take all memory or time.

use super::road_line::RoadLine;
use std::collections::BTreeMap;

/// Most cells of all ways: 50,000 km.
const MOST_CELLS: usize = 20_000_000;
/// Most points of all ways, both directions.
const MOST_POINTS: usize = 2_000_000;
/// Most pairs of points at the same place. Where ten ways meet there are 380 in both directions.
const MOST_PAIRS: usize = 4_000_000;
/// Most points in a square of [`SQUARE`].
const MOST_NEAR: u32 = 10_000;
/// Size of a square, 1/deg: about 100 m.
const SQUARE: f64 = 1e3;
/// Size of a place, 1/deg: a centimetre.
const PLACE: f64 = 1e7;

/// Why a network is too large.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum NetworkProblem {
    /// Too many cells.
    #[error("more than {MOST_CELLS} cells of 2.5 m; expected a smaller network")]
    Cells,
    /// Too many points.
    #[error("more than {MOST_POINTS} points, both directions; expected a smaller network")]
    Points,
    /// Ways pass the same places too often.
    #[error("more than {MOST_PAIRS} pairs of points at the same places; expected roads")]
    Shared,
    /// Too many points at one place.
    #[error("more than {MOST_NEAR} points within 100 m at {0:.3}, {1:.3}; expected roads")]
    Dense(f64, f64),
}

/// Counts the ways of a network while it is read.
#[derive(Debug, Default)]
pub struct NetworkSize {
    cells: usize,
    points: usize,
    squares: BTreeMap<[i32; 2], u32>,
}

impl NetworkSize {
    /// Counts an empty network.
    #[must_use]
    pub const fn new() -> Self {
        Self {
            cells: 0,
            points: 0,
            squares: BTreeMap::new(),
        }
    }

    /// Adds a way.
    ///
    /// # Errors
    /// Returns an error if the network becomes too large.
    pub fn add(&mut self, line: &RoadLine) -> Result<(), NetworkProblem> {
        let numbers = line.cell_numbers();
        self.cells += usize::try_from(numbers.end() - numbers.start() + 1).unwrap_or(0);
        self.points += line.points().len();
        if self.cells > MOST_CELLS {
            return Err(NetworkProblem::Cells);
        }
        if self.points > MOST_POINTS {
            return Err(NetworkProblem::Points);
        }
        for point in line.points() {
            let place = [point.latitude_deg, point.longitude_deg];
            let square = place.map(|angle| (angle * SQUARE).floor() as i32);
            let count = self.squares.entry(square).or_default();
            *count += 1;
            if *count > MOST_NEAR {
                return Err(NetworkProblem::Dense(place[0], place[1]));
            }
        }
        Ok(())
    }

    /// Checks how often ways meet.
    ///
    /// # Errors
    /// Returns an error if they do so too often for roads.
    pub fn check_meetings<'a>(
        lines: impl Iterator<Item = &'a RoadLine>,
    ) -> Result<(), NetworkProblem> {
        let mut places: Vec<[i64; 2]> = lines
            .flat_map(RoadLine::points)
            .map(|point| {
                [point.latitude_deg, point.longitude_deg]
                    .map(|angle| (angle * PLACE).round() as i64)
            })
            .collect();
        places.sort_unstable();
        let pairs = places
            .chunk_by(|a, b| a == b)
            .map(|same| same.len().pow(2) - same.len());
        if pairs.sum::<usize>() > MOST_PAIRS {
            return Err(NetworkProblem::Shared);
        }
        Ok(())
    }
}
