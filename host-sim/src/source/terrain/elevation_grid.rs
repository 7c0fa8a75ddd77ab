//! Posts of elevation on a grid of latitude and longitude.

/// Altitudes that ground has, m: from below the Dead Sea and open pits to above Mount Everest. What
/// is beyond marks a post without a measurement: -32768, -9999, or none in 32 bits.
const GROUND_M: std::ops::RangeInclusive<f32> = -700.0..=9_000.0;

/// What a place may be off by the arithmetic, steps. So near to a post, it is there.
const ROUNDING_STEPS: f64 = 1e-6;

/// Where the posts of a grid are, deg.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct GridPlace {
    /// Latitude of the first row, the northern one.
    pub north_deg: f64,
    /// Longitude of the first column, the western one.
    pub west_deg: f64,
    /// Between rows.
    pub row_step_deg: f64,
    /// Between columns.
    pub column_step_deg: f64,
    pub rows: usize,
    pub columns: usize,
    /// Steps beyond the outer posts that have their altitude: one where the grid of a neighbour goes
    /// on after it, none where grids share their outer posts.
    pub reach_steps: f64,
}

impl GridPlace {
    /// Returns row and column of a place, with their fractions.
    fn at(&self, latitude_deg: f64, longitude_deg: f64) -> Option<(f64, f64)> {
        let within = |at: f64, count: usize| {
            let last = count.checked_sub(1)? as f64;
            let beyond = self.reach_steps + ROUNDING_STEPS;
            let post = at.round();
            let is_post = (at - post).abs() < ROUNDING_STEPS;
            (-beyond..=last + beyond)
                .contains(&at)
                .then(|| if is_post { post } else { at }.clamp(0.0, last))
        };
        Some((
            within(
                (self.north_deg - latitude_deg) / self.row_step_deg,
                self.rows,
            )?,
            within(
                (longitude_deg - self.west_deg) / self.column_step_deg,
                self.columns,
            )?,
        ))
    }

    /// Returns true if the grid has this place.
    pub(super) fn has(&self, latitude_deg: f64, longitude_deg: f64) -> bool {
        self.at(latitude_deg, longitude_deg).is_some()
    }
}

/// Altitudes of ground.
#[derive(Debug)]
pub(super) struct ElevationGrid {
    place: GridPlace,
    /// Row by row from north, each from west.
    posts_m: Vec<f32>,
    void_m: Option<f32>,
}

impl ElevationGrid {
    /// Creates a grid. `void_m` marks posts without a measurement, beside those that no ground has.
    pub(super) const fn new(place: GridPlace, posts_m: Vec<f32>, void_m: Option<f32>) -> Self {
        Self {
            place,
            posts_m,
            void_m,
        }
    }

    /// Returns true if the grid has this place.
    pub(super) fn has(&self, latitude_deg: f64, longitude_deg: f64) -> bool {
        self.place.has(latitude_deg, longitude_deg)
    }

    /// Returns the altitude, m, by bilinear interpolation between the four posts around. Returns
    /// `None` if one of them is void, and outside the grid.
    pub(super) fn altitude_m(&self, latitude_deg: f64, longitude_deg: f64) -> Option<f64> {
        let (row, column) = self.place.at(latitude_deg, longitude_deg)?;
        let (down, right) = (row.fract(), column.fract());
        let (row, column) = (row as usize, column as usize);
        [
            (row, column, (1.0 - down) * (1.0 - right)),
            (row, column + 1, (1.0 - down) * right),
            (row + 1, column, down * (1.0 - right)),
            (row + 1, column + 1, down * right),
        ]
        .into_iter()
        .filter(|(_, _, weight)| *weight > 0.0)
        .map(|(row, column, weight)| Some(weight * f64::from(self.post_m(row, column)?)))
        .sum()
    }

    fn post_m(&self, row: usize, column: usize) -> Option<f32> {
        let post_m = *self.posts_m.get(row * self.place.columns + column)?;
        (GROUND_M.contains(&post_m) && Some(post_m) != self.void_m).then_some(post_m)
    }
}
