//! SUMS.csv: the sums behind a map, so that it can grow without the runs that made it.
//!
//! First the road: a row for every cell of it, with its position and the sums of the runs that
//! belong to no session. Then, session by session, a row for each cell that one of its runs
//! covered. Numbers are written in full, so that nothing changes on the way. The first line holds
//! version, number of rows and number of runs; behind the rows follows what each run is known by.

use super::GRID_M;
use super::cell_sums::CellSums;
use super::fusion::GradeMap;
use super::plane::chord_m;
use super::road_line::{RoadLine, RoadPoint};
use super::run_list::RunList;
use crate::error::{Error, Result};
use crate::output::Staged;
use crate::row_check::{self, Flaw};
use crate::run_file::{column, read_checked_with};
use serde::{Deserialize, Serialize};
use std::fs::File;
use std::io::{BufRead, BufReader, Read};
use std::path::Path;

/// What a file of this kind begins with; the number is that of its version.
const MARK: &str = "# roadgrade sums 2, rows: ";
/// What stands between the numbers of rows and of runs.
const RUNS_MARK: &str = ", runs: ";
/// A first line is not longer than this, bytes.
const LONGEST_MARK: u64 = 80;
/// Lines before the first row: mark and header.
const LINES_BEFORE: u64 = 2;
/// Cells of one road lie within this of each other, m: coordinates rounded in a file.
const SAME_PLACE_M: f64 = 0.5;
/// Sums may miss an inequality by so much in proportion: rounding.
const ROUNDING: f64 = 1e-9;

/// One cell of the road, or of a session.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct StoreRow {
    distance_m: f64,
    /// Empty for the road and runs without a session.
    #[serde(deserialize_with = "column")]
    session: Option<String>,
    /// Of the road; empty in the rows of a session.
    #[serde(deserialize_with = "column")]
    latitude_deg: Option<f64>,
    #[serde(deserialize_with = "column")]
    longitude_deg: Option<f64>,
    runs: u32,
    weight: f64,
    weight_square: f64,
    grade_sum: f64,
    grade_square_sum: f64,
    altitude_weight: f64,
    altitude_sum: f64,
}

/// A map as stored.
#[derive(Clone, Debug)]
pub struct Store {
    /// The road, at each of its cells.
    pub road: Vec<RoadPoint>,
    rows: Vec<StoreRow>,
    /// The runs behind it.
    pub runs: RunList,
}

impl Store {
    /// The stored map, on the road through [`Store::road`].
    pub fn resume<'a>(&self, road: &'a RoadLine) -> GradeMap<'a> {
        let mut map = GradeMap::new(road);
        let first = number_of(self.road[0].distance_m);
        for row in &self.rows {
            let index = usize::try_from(number_of(row.distance_m) - first).ok();
            let cells = map.cells_of(row.session.as_deref());
            if let Some(cell) = index.and_then(|index| cells.get_mut(index)) {
                cell.merge(&row.sums());
            }
        }
        map
    }

    /// Whether this is the store of that road.
    pub fn is_of(&self, road: &RoadLine) -> bool {
        let place = |point: &RoadPoint| (point.latitude_deg, point.longitude_deg, 0.0);
        let given = road.on_grid();
        given.len() == self.road.len()
            && given.iter().zip(&self.road).all(|(a, b)| {
                a.distance_m == b.distance_m && chord_m(place(a), place(b)) < SAME_PLACE_M
            })
    }
}

/// A name that a session can have in files and messages.
///
/// # Errors
/// What is wrong with it, and what would do.
pub fn check_session_name(name: &str) -> std::result::Result<(), Flaw> {
    if name.trim().is_empty() || name.chars().any(char::is_control) {
        return Err(Flaw {
            problem: format!("session name {name:?}"),
            expected: "some letters or digits, no line breaks",
        });
    }
    Ok(())
}

/// Writes a map's sums, to appear when committed. The map's road must be one through its own
/// [`RoadLine::on_grid`].
///
/// # Errors
/// What the file system says.
pub fn stage(path: &Path, map: &GradeMap, runs: &RunList) -> Result<Staged> {
    let road = map.road().on_grid();
    let rows: Vec<StoreRow> = map
        .sums()
        .flat_map(|(session, cells)| {
            road.iter()
                .zip(cells)
                .filter(move |(_, sums)| session.is_none() || sums.estimates > 0)
                .map(move |(point, sums)| StoreRow::new(session, point, sums))
        })
        .collect();
    crate::output::stage(path, |out| {
        writeln!(out, "{MARK}{}{RUNS_MARK}{}", rows.len(), runs.len())?;
        let mut writer = csv::Writer::from_writer(&mut *out);
        for row in &rows {
            writer.serialize(row).map_err(std::io::Error::other)?;
        }
        writer.flush()?;
        drop(writer);
        runs.write(out)
    })
}

/// Reads a map's sums.
///
/// # Errors
/// With file, line and what was expected.
pub fn read(path: &Path) -> Result<Store> {
    let (promised, promised_runs) = promised_counts(path)?;
    let rows = read_checked_with(
        csv::ReaderBuilder::new().comment(Some(b'#')),
        path,
        StoreRow::check,
    )?;
    if rows.len() != promised {
        return Err(Error::content(
            path,
            format!(
                "{} rows; expected the {promised} of its first line",
                rows.len()
            ),
        ));
    }
    let road: Vec<RoadPoint> = rows.iter().map_while(StoreRow::point).collect();
    // The check has seen to it that the first row is of the road.
    let (start_m, end_m) = (road[0].distance_m, road[road.len() - 1].distance_m);
    if let Some(i) = rows
        .iter()
        .position(|row| !(start_m..=end_m).contains(&row.distance_m))
    {
        return Err(Error::line(
            path,
            i as u64 + 1 + LINES_BEFORE,
            format!("distance_m is {}", rows[i].distance_m),
            format!("a cell of the road, {start_m} to {end_m}"),
        ));
    }
    let runs = RunList::read(path, promised_runs)?;
    Ok(Store { road, rows, runs })
}

/// The numbers of rows and of runs that the first line tells.
fn promised_counts(path: &Path) -> Result<(usize, usize)> {
    let file = File::open(path).map_err(Error::io(path))?;
    let mut first = Vec::new();
    BufReader::new(file.take(LONGEST_MARK))
        .read_until(b'\n', &mut first)
        .map_err(Error::io(path))?;
    let first = String::from_utf8_lossy(&first);
    first
        .trim_end()
        .strip_prefix(MARK)
        .and_then(|counts| counts.split_once(RUNS_MARK))
        .and_then(|(rows, runs)| Some((rows.parse().ok()?, runs.parse().ok()?)))
        .ok_or_else(|| {
            Error::line(
                path,
                1,
                "not a store of this version",
                format!("\"{MARK}\" and their numbers, as fuse --store writes it"),
            )
        })
}

fn number_of(distance_m: f64) -> i64 {
    (distance_m / GRID_M).round() as i64
}

impl StoreRow {
    fn new(session: Option<&str>, point: &RoadPoint, sums: &CellSums) -> Self {
        let of_road = session.is_none();
        Self {
            distance_m: point.distance_m,
            session: session.map(str::to_owned),
            latitude_deg: of_road.then_some(point.latitude_deg),
            longitude_deg: of_road.then_some(point.longitude_deg),
            runs: sums.estimates,
            weight: sums.weight,
            weight_square: sums.weight_square,
            grade_sum: sums.grade,
            grade_square_sum: sums.grade_square,
            altitude_weight: sums.altitude_weight,
            altitude_sum: sums.altitude,
        }
    }

    fn sums(&self) -> CellSums {
        CellSums {
            estimates: self.runs,
            weight: self.weight,
            weight_square: self.weight_square,
            grade: self.grade_sum,
            grade_square: self.grade_square_sum,
            altitude_weight: self.altitude_weight,
            altitude: self.altitude_sum,
        }
    }

    /// Of the road; `None` in the rows of a session.
    fn point(&self) -> Option<RoadPoint> {
        Some(RoadPoint {
            distance_m: self.distance_m,
            latitude_deg: self.latitude_deg?,
            longitude_deg: self.longitude_deg?,
        })
    }

    /// Whether the row can follow `before`.
    fn check(before: Option<&Self>, row: &Self) -> std::result::Result<(), Flaw> {
        row_check::finite(&[
            ("distance_m", row.distance_m),
            ("weight", row.weight),
            ("weight_square", row.weight_square),
            ("grade_sum", row.grade_sum),
            ("grade_square_sum", row.grade_square_sum),
            ("altitude_weight", row.altitude_weight),
            ("altitude_sum", row.altitude_sum),
        ])?;
        if (row.distance_m / GRID_M).fract() != 0.0 {
            return Err(Flaw {
                problem: format!("distance_m is {}", row.distance_m),
                expected: "a multiple of 2.5",
            });
        }
        row.check_place(before)?;
        row.check_sums()
    }

    /// The road from cell to cell, then sessions in the order of their names, each forwards.
    fn check_place(&self, before: Option<&Self>) -> std::result::Result<(), Flaw> {
        let wrong = |problem: &str, expected: &'static str| {
            Err(Flaw {
                problem: problem.to_owned(),
                expected,
            })
        };
        match (&self.session, self.latitude_deg, self.longitude_deg) {
            (None, Some(latitude_deg), Some(longitude_deg)) => {
                row_check::position(latitude_deg, longitude_deg)?;
                match before {
                    None => Ok(()),
                    Some(before) if before.session.is_some() => {
                        wrong("a cell of the road behind a session", "the road first")
                    }
                    Some(before) if self.distance_m != before.distance_m + GRID_M => Err(Flaw {
                        problem: format!(
                            "distance_m is {} after {}",
                            self.distance_m, before.distance_m
                        ),
                        expected: "every cell of the road, each 2.5 m behind the one before",
                    }),
                    Some(_) => Ok(()),
                }
            }
            (None, ..) => wrong("a cell of the road without a position", "both angles"),
            (Some(_), None, None) => {
                let Some(before) = before else {
                    return wrong("a session in the first row", "the road first");
                };
                if before.session == self.session {
                    let (last_m, now_m) = (before.distance_m, self.distance_m);
                    return row_check::forwards("distance_m", last_m, now_m, true);
                }
                if before.session > self.session {
                    return wrong(
                        "a session behind one of a later name",
                        "the order of their names, each in one piece",
                    );
                }
                self.session.as_deref().map_or(Ok(()), check_session_name)
            }
            (Some(_), ..) => wrong(
                "a position in a row of a session",
                "only the road's rows to",
            ),
        }
    }

    /// What sums of weights and values cannot but fulfil.
    fn check_sums(&self) -> std::result::Result<(), Flaw> {
        let runs = f64::from(self.runs);
        let at_most = |a: f64, b: f64| a <= b * (1.0 + ROUNDING);
        let possible = if self.runs == 0 {
            self.session.is_none() && self.sums() == CellSums::default()
        } else {
            self.weight > 0.0
                && self.weight_square > 0.0
                && at_most(self.weight * self.weight, runs * self.weight_square)
                && at_most(self.weight_square, self.weight * self.weight)
                && at_most(
                    self.grade_sum * self.grade_sum,
                    self.weight * self.grade_square_sum,
                )
                && self.altitude_weight >= 0.0
                && (self.altitude_weight > 0.0 || self.altitude_sum == 0.0)
        };
        if possible {
            Ok(())
        } else {
            Err(Flaw {
                problem: format!("sums that {} runs cannot have", self.runs),
                expected: "the row as it was written",
            })
        }
    }
}
