//! One row of SUMS.csv, and its consistency checks.

use super::session_name::check_session_name;
use crate::files::columns;
use crate::files::csv::column;
use crate::files::row_check::{self, Flaw};
use crate::map::fusion::cell_sums::CellSums;
use crate::map::geometry::grid::GRID_M;
use crate::map::geometry::road_line::RoadPoint;
use crate::map::geometry::way_name::{WayDirection, WayName};
use serde::{Deserialize, Serialize};

/// Relative tolerance of the inequalities of sums: rounding.
const ROUNDING: f64 = 1e-9;

/// A road or a way as stored.
#[derive(Clone, Debug, PartialEq)]
pub struct StoredWay {
    /// Name of the way; `None` for a single road.
    pub name: Option<WayName>,
    /// Position of each of its cells.
    pub cells: Vec<RoadPoint>,
}

/// One cell of the road, or of a session.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct StoreRow {
    pub distance_m: f64,
    /// Session; empty for the road and runs without a session.
    #[serde(deserialize_with = "column")]
    pub session: Option<String>,
    /// Position of the road's cell; empty in the rows of a session.
    #[serde(deserialize_with = "column")]
    latitude_deg: Option<f64>,
    #[serde(deserialize_with = "column")]
    longitude_deg: Option<f64>,
    pub runs: u32,
    weight: f64,
    weight_square: f64,
    grade_sum: f64,
    grade_square_sum: f64,
    altitude_weight: f64,
    altitude_sum: f64,
    /// Way of a network; written as [`WayColumns`].
    #[serde(default, skip_serializing)]
    way: Option<String>,
    #[serde(default, skip_serializing)]
    direction: Option<WayDirection>,
}

impl StoreRow {
    pub(crate) fn new(
        session: Option<&str>,
        name: Option<&WayName>,
        point: &RoadPoint,
        sums: &CellSums,
    ) -> Self {
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
            way: name.map(|name| name.way.clone()),
            direction: name.map(|name| name.direction),
        }
    }

    /// Returns the name of the way; `None` on a single road.
    pub(crate) fn way_name(&self) -> Option<WayName> {
        Some(WayName {
            way: self.way.clone()?,
            direction: self.direction?,
        })
    }

    /// Returns true if both rows are of the same session and way.
    pub(crate) fn is_beside(&self, other: &Self) -> bool {
        (&self.session, &self.way, self.direction) == (&other.session, &other.way, other.direction)
    }

    /// Returns true if the row is of a cell of these ways, which are sorted by name.
    pub(crate) fn is_on(&self, ways: &[StoredWay]) -> bool {
        let name = self.way_name();
        let Ok(way) = ways.binary_search_by(|way| way.name.cmp(&name)) else {
            return false;
        };
        let cells = &ways[way].cells;
        (cells[0].distance_m..=cells[cells.len() - 1].distance_m).contains(&self.distance_m)
    }

    pub(crate) fn sums(&self) -> CellSums {
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

    /// Returns the position of the road's cell; `None` in the rows of a session.
    pub(crate) fn point(&self) -> Option<RoadPoint> {
        Some(RoadPoint {
            distance_m: self.distance_m,
            latitude_deg: self.latitude_deg?,
            longitude_deg: self.longitude_deg?,
        })
    }

    /// Checks that the row can follow `before`.
    pub(crate) fn check(before: Option<&Self>, row: &Self) -> Result<(), Flaw> {
        row_check::within(&[
            (columns::DISTANCE_M, row.distance_m),
            (columns::WEIGHT, row.weight),
            (columns::WEIGHT_SQUARE, row.weight_square),
            (columns::GRADE_SUM, row.grade_sum),
            (columns::GRADE_SQUARE_SUM, row.grade_square_sum),
            (columns::ALTITUDE_WEIGHT, row.altitude_weight),
            (columns::ALTITUDE_SUM, row.altitude_sum),
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

    /// Checks the order: the road from cell to cell, or the ways sorted by name; then the sessions
    /// sorted by name, each way by way and forwards.
    fn check_place(&self, before: Option<&Self>) -> Result<(), Flaw> {
        let wrong = |problem: &str, expected: &'static str| {
            Err(Flaw {
                problem: problem.to_owned(),
                expected,
            })
        };
        if self.way.is_some() != self.direction.is_some()
            || before.is_some_and(|before| before.way.is_some() != self.way.is_some())
        {
            return wrong(
                "incomplete name of a way",
                "both way and direction, or neither",
            );
        }
        let next_way = before.is_some_and(|before| {
            before.session == self.session && before.way_name() < self.way_name()
        });
        match (&self.session, self.latitude_deg, self.longitude_deg) {
            (None, Some(latitude_deg), Some(longitude_deg)) => {
                row_check::position(latitude_deg, longitude_deg)?;
                match before {
                    None => Ok(()),
                    Some(before) if before.session.is_some() => {
                        wrong("a cell of the road behind a session", "the road first")
                    }
                    Some(_) if next_way => Ok(()),
                    Some(before) if before.way_name() != self.way_name() => wrong(
                        "ways out of order",
                        "ways sorted by name, each in one block",
                    ),
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
                if next_way {
                    return Ok(());
                }
                if before.session == self.session {
                    if before.way_name() != self.way_name() {
                        return wrong(
                            "ways out of order",
                            "ways sorted by name, each in one block",
                        );
                    }
                    let (last_m, now_m) = (before.distance_m, self.distance_m);
                    return row_check::forwards("distance_m", last_m, now_m, true);
                }
                if before.session > self.session {
                    return wrong(
                        "sessions out of order",
                        "sessions sorted by name, each in one block",
                    );
                }
                self.session.as_deref().map_or(Ok(()), check_session_name)
            }
            (Some(_), ..) => wrong(
                "a position in a row of a session",
                "positions only in the rows of the road",
            ),
        }
    }

    /// Checks the inequalities between sums of weights and values.
    fn check_sums(&self) -> Result<(), Flaw> {
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
                problem: format!("sums that are impossible for {} runs", self.runs),
                expected: "the row as it was written",
            })
        }
    }
}
