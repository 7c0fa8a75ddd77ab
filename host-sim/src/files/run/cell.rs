//! The columns of a run that fusion needs, and the identity of a run.

use super::row::RunRow;
use crate::files::columns::{self, Column};
use crate::files::row_check::{self, Flaw};
use std::collections::VecDeque;
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
    /// False where signals disagree: the sigmas may be too small.
    pub is_consistent: bool,
}

impl From<&RunRow> for RunCell {
    fn from(row: &RunRow) -> Self {
        Self {
            distance_m: row.distance_m,
            position: row.latitude_deg.zip(row.longitude_deg),
            altitude: row.altitude_m.zip(row.altitude_sigma_m),
            grade_percent: row.grade_percent,
            grade_sigma_percent: row.grade_sigma_percent,
            is_consistent: row.consistent == 1,
        }
    }
}

impl From<&Self> for RunCell {
    fn from(cell: &Self) -> Self {
        *cell
    }
}

impl RunCell {
    /// Checks that the cell can follow one at this distance in a run.
    ///
    /// # Errors
    /// Returns an error that names the problem of the cell.
    pub(crate) fn check(&self, before_m: Option<f64>) -> Result<(), Flaw> {
        row_check::within(&[
            (columns::DRIVEN_M, self.distance_m),
            (columns::GRADE_PERCENT, self.grade_percent),
            (columns::GRADE_SIGMA_PERCENT, self.grade_sigma_percent),
        ])?;
        row_check::within_if_known(&[
            (columns::LATITUDE_DEG, self.position.map(|at| at.0)),
            (columns::LONGITUDE_DEG, self.position.map(|at| at.1)),
            (columns::ALTITUDE_M, self.altitude.map(|known| known.0)),
            (
                columns::ALTITUDE_SIGMA_M,
                self.altitude.map(|known| known.1),
            ),
        ])?;
        before_m.map_or(Ok(()), |before_m| {
            row_check::forwards("distance_m", before_m, self.distance_m, true)
        })
    }
}

/// Returns true if all cells of these columns have numbers within their ranges, all known: distance,
/// latitude, longitude, altitude and its sigma, grade and its sigma.
pub(super) fn are_within(columns: [&[f64]; 7]) -> bool {
    let ranges = [
        columns::DRIVEN_M,
        columns::LATITUDE_DEG,
        columns::LONGITUDE_DEG,
        columns::ALTITUDE_M,
        columns::ALTITUDE_SIGMA_M,
        columns::GRADE_PERCENT,
        columns::GRADE_SIGMA_PERCENT,
    ];
    // All numbers, without a branch for each: several at once.
    let is_within = |(numbers, range): (&[f64], Column)| {
        numbers
            .iter()
            .fold(true, |all, &number| all & range.holds(number))
    };
    columns.into_iter().zip(ranges).all(is_within)
}

/// Rows of a run in which it must advance by [`DENSE_M`]. Cells are 2.5 m long.
const DENSE_ROWS: usize = 1_000;
const DENSE_M: f64 = 500.0;

/// Steps of this length and longer are not too dense, m.
const STEADY_M: f64 = DENSE_M / (DENSE_ROWS - 1) as f64 + 1e-6;

/// Check that the rows of a run are not too close together. Windows of a run are cut by distance,
/// not by rows.
#[derive(Default)]
pub(super) struct Density {
    /// Distances of the last rows, m.
    last_m: VecDeque<f64>,
    /// True if a step was shorter than [`STEADY_M`].
    is_uneven: bool,
}

impl Density {
    /// Takes the distances of many rows if all steps so far are long. Otherwise returns `false`, and
    /// they are to be checked one by one.
    pub(super) fn takes_all(&mut self, distances_m: &[f64]) -> bool {
        let is_long = |from_m: f64, to_m: f64| to_m - from_m >= STEADY_M;
        let follows = |first: &f64| self.last_m.back().is_none_or(|&last| is_long(last, *first));
        let steps = distances_m.windows(2);
        let is_steady = !self.is_uneven
            && distances_m.first().is_none_or(follows)
            && steps.fold(true, |all, step| all & is_long(step[0], step[1]));
        if !is_steady {
            self.is_uneven = true;
            return false;
        }
        let tail = distances_m.len().saturating_sub(DENSE_ROWS - 1);
        self.last_m.extend(&distances_m[tail..]);
        let surplus = self.last_m.len().saturating_sub(DENSE_ROWS - 1);
        self.last_m.drain(..surplus);
        true
    }

    /// Takes the distance of the next row.
    ///
    /// # Errors
    /// Names the problem.
    pub(super) fn check(&mut self, distance_m: f64) -> Result<(), Flaw> {
        self.last_m.push_back(distance_m);
        if self.last_m.len() < DENSE_ROWS {
            return Ok(());
        }
        match self.last_m.pop_front() {
            Some(first_m) if distance_m - first_m < DENSE_M => Err(Flaw {
                problem: format!("{DENSE_ROWS} rows within {DENSE_M} m"),
                expected: "cells of 2.5 m",
            }),
            _ => Ok(()),
        }
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

/// What the hash takes after a cell that is not consistent.
const SUSPECT: &[u8; 8] = b"suspect\0";

/// Bytes that the hash takes at once: far fewer calls than one a cell.
const HASH_BYTES: usize = 4096;

/// Hash of a run, cell by cell.
#[derive(Clone, Default)]
pub struct RunHash {
    hash: Xxh3,
    /// Bytes that the hash has yet to take.
    waiting: Vec<u8>,
}

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
        self.waiting.extend_from_slice(&bytes);
        // Only then, so that runs without a mark keep the identity that they always had.
        if !cell.is_consistent {
            self.waiting.extend_from_slice(SUSPECT);
        }
        if self.waiting.len() >= HASH_BYTES {
            self.hash.update(&self.waiting);
            self.waiting.clear();
        }
    }

    /// Returns the identity of the cells so far.
    #[must_use]
    pub fn identity(&self) -> RunIdentity {
        let mut hash = self.hash.clone();
        hash.update(&self.waiting);
        RunIdentity(hash.digest128())
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
