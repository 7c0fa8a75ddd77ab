//! The columns of a run that fusion needs, and the identity of a run.

use super::row::RunRow;
use crate::files::row_check::{self, Flaw};
use std::fmt;
use std::str::FromStr;
use xxhash_rust::xxh3::Xxh3;

/// One cell of a run, with the columns that a map is made of.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RunCell {
    /// Driven distance by the odometer, m.
    pub distance_m: f64,
    /// Latitude and longitude, deg; `None` where no fix was near.
    pub position: Option<(f64, f64)>,
    /// Altitude and its standard deviation, m.
    pub altitude: Option<(f64, f64)>,
    /// Smoothed grade, %.
    pub grade_percent: f64,
    /// Standard deviation of the smoothed grade, %.
    pub grade_sigma_percent: f64,
}

impl From<&RunRow> for RunCell {
    fn from(row: &RunRow) -> Self {
        Self {
            distance_m: row.distance_m,
            position: row.latitude_deg.zip(row.longitude_deg),
            altitude: row.altitude_m.zip(row.altitude_sigma_m),
            grade_percent: row.grade_percent,
            grade_sigma_percent: row.grade_sigma_percent,
        }
    }
}

impl From<&Self> for RunCell {
    fn from(cell: &Self) -> Self {
        *cell
    }
}

impl RunCell {
    /// Checks that the cell can follow `before` in a run.
    ///
    /// # Errors
    /// Returns an error that names the problem of the cell.
    pub(crate) fn check(&self, before: Option<&Self>) -> Result<(), Flaw> {
        let (latitude_deg, longitude_deg) = self.position.unwrap_or((0.0, 0.0));
        let (altitude_m, altitude_sigma_m) = self.altitude.unwrap_or((0.0, 1.0));
        row_check::finite(&[
            ("distance_m", self.distance_m),
            ("latitude_deg", latitude_deg),
            ("longitude_deg", longitude_deg),
            ("altitude_m", altitude_m),
            ("altitude_sigma_m", altitude_sigma_m),
            ("grade_percent", self.grade_percent),
            ("grade_sigma_percent", self.grade_sigma_percent),
        ])?;
        row_check::positive(&[
            ("altitude_sigma_m", altitude_sigma_m),
            ("grade_sigma_percent", self.grade_sigma_percent),
        ])?;
        row_check::position(latitude_deg, longitude_deg)?;
        before.map_or(Ok(()), |before| {
            row_check::forwards("distance_m", before.distance_m, self.distance_m, true)
        })
    }
}

/// The identity of a run: a hash of 128 bits over its cells. It does not depend on the name or
/// format of the file. It detects runs that are added twice, and damaged files.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct RunIdentity(u128);

impl RunIdentity {
    /// Computes the identity of these cells.
    pub fn of(cells: impl IntoIterator<Item = RunCell>) -> Self {
        let mut hash = RunHash::default();
        for cell in cells {
            hash.add(&cell);
        }
        hash.identity()
    }
}

/// Hash of a run, cell by cell.
#[derive(Default)]
pub struct RunHash(Xxh3);

impl RunHash {
    /// Takes the next cell.
    pub fn add(&mut self, cell: &RunCell) {
        // No number of a run is NaN, so NaN can stand for a missing value.
        let pair = |pair: Option<(f64, f64)>| pair.unwrap_or((f64::NAN, f64::NAN));
        let (position, altitude) = (pair(cell.position), pair(cell.altitude));
        let values = [
            cell.distance_m,
            position.0,
            position.1,
            altitude.0,
            altitude.1,
            cell.grade_percent,
            cell.grade_sigma_percent,
        ];
        let mut bytes = [0; 7 * size_of::<f64>()];
        for (bytes, value) in bytes.chunks_exact_mut(size_of::<f64>()).zip(values) {
            // Not every text writer distinguishes minus zero from zero.
            bytes.copy_from_slice(&(value + 0.0).to_le_bytes());
        }
        self.0.update(&bytes);
    }

    /// Returns the identity of the cells so far.
    #[must_use]
    pub fn identity(&self) -> RunIdentity {
        RunIdentity(self.0.digest128())
    }
}

impl fmt::Display for RunIdentity {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:032x}", self.0)
    }
}

impl FromStr for RunIdentity {
    type Err = ();

    fn from_str(text: &str) -> Result<Self, ()> {
        let is_hex = text.len() == 32 && text.bytes().all(|byte| byte.is_ascii_hexdigit());
        is_hex
            .then(|| u128::from_str_radix(text, 16).ok())
            .flatten()
            .map(Self)
            .ok_or(())
    }
}
