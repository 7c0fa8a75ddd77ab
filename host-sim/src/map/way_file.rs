//! Files that hold one road, or several ways: then `way` and `direction` are columns.

use super::network::{Direction, WayName};
use crate::error::{Error, Result};
use crate::files::csv::{Record, read_records};
use crate::files::row_check::Flaw;
use serde::{Deserialize, Serialize};
use std::collections::BTreeSet;
use std::path::Path;

/// The column that says that a file holds ways.
pub(super) const WAY: &str = "way";
/// The column beside it; without it all are driven forward.
pub(super) const DIRECTION: &str = "direction";

/// Rows of one way.
#[derive(Clone, Debug, PartialEq)]
pub struct WayRows<T = super::MapRow> {
    /// `None` for a single road.
    pub name: Option<WayName>,
    pub rows: Vec<T>,
}

/// What tells the way in a row.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct WayColumns {
    way: String,
    #[serde(default)]
    direction: Option<Direction>,
}

impl From<Option<&WayName>> for WayColumns {
    fn from(name: Option<&WayName>) -> Self {
        Self {
            way: name.map(|name| name.way.clone()).unwrap_or_default(),
            direction: name.map(|name| name.direction),
        }
    }
}

impl WayColumns {
    fn name(self) -> std::result::Result<WayName, Flaw> {
        check_way(&self.way)?;
        Ok(WayName {
            way: self.way,
            direction: self.direction.unwrap_or(Direction::Forward),
        })
    }
}

/// A way's name, as a file gives it.
pub(super) fn check_way(way: &str) -> std::result::Result<(), Flaw> {
    if way.trim().is_empty() || way.chars().any(char::is_control) {
        return Err(Flaw {
            problem: format!("way is {way:?}"),
            expected: "a name of some letters or digits",
        });
    }
    Ok(())
}

/// Rows as they come, to be told apart by way.
pub(super) struct Grouping<T> {
    ways: Vec<WayRows<T>>,
    seen: BTreeSet<WayName>,
}

impl<T> Grouping<T> {
    pub(super) const fn new() -> Self {
        Self {
            ways: Vec::new(),
            seen: BTreeSet::new(),
        }
    }

    /// Adds a row behind those of its way; `check` judges it with the one before.
    pub(super) fn add(
        &mut self,
        name: Option<WayName>,
        row: T,
        check: impl Fn(Option<&T>, &T) -> std::result::Result<(), Flaw>,
    ) -> std::result::Result<(), Flaw> {
        if let Some(way) = self.ways.last_mut().filter(|way| way.name == name) {
            check(way.rows.last(), &row)?;
            way.rows.push(row);
            return Ok(());
        }
        check(None, &row)?;
        if let Some(name) = &name
            && !self.seen.insert(name.clone())
        {
            return Err(Flaw {
                problem: format!("way {name} once more"),
                expected: "the rows of a way one behind the other",
            });
        }
        let rows = vec![row];
        self.ways.push(WayRows { name, rows });
        Ok(())
    }

    pub(super) fn done(self) -> Vec<WayRows<T>> {
        self.ways
    }
}

/// Reads the rows of a CSV file, way by way.
///
/// # Errors
/// With file, line and what was expected.
pub(super) fn read_csv<T: for<'de> Deserialize<'de>>(
    path: &Path,
    check: fn(Option<&T>, &T) -> std::result::Result<(), Flaw>,
) -> Result<Vec<WayRows<T>>> {
    let mut grouping = Grouping::new();
    read_records(&csv::ReaderBuilder::new(), path, |record: &Record| {
        let name = if record.has_column(WAY) {
            let columns: WayColumns = record.read()?;
            Some(columns.name().map_err(|flaw| record.error(flaw))?)
        } else {
            None
        };
        grouping
            .add(name, record.read()?, check)
            .map_err(|flaw| record.error(flaw))
    })?;
    Ok(grouping.done())
}

/// A way's name from the columns of a Parquet file.
pub(super) fn name_of([way, direction]: [Option<&str>; 2]) -> std::result::Result<WayName, Flaw> {
    let direction = match direction {
        None => None,
        Some("forward") => Some(Direction::Forward),
        Some("backward") => Some(Direction::Backward),
        Some(other) => {
            return Err(Flaw {
                problem: format!("direction is {other:?}"),
                expected: "forward or backward",
            });
        }
    };
    let way = way.unwrap_or_default().to_owned();
    WayColumns { way, direction }.name()
}

/// The rows of a file that is to hold a single road.
pub(super) fn single<T>(path: &Path, mut ways: Vec<WayRows<T>>) -> Result<Vec<T>> {
    match ways.len() {
        0 => Ok(Vec::new()),
        1 => Ok(ways.swap_remove(0).rows),
        several => {
            let problem = format!("{several} ways; expected a single road here");
            Err(Error::content(path, problem))
        }
    }
}
