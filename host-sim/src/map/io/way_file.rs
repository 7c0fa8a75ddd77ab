//! Files that hold one road, or several ways: then `way` and `direction` are columns.

use crate::error::{Error, Result};
use crate::files::csv::{Record, read_records};
use crate::files::row_check::Flaw;
use crate::map::fusion::map_row::WayRows;
use crate::map::geometry::way_name::{Direction, WayName};
use serde::{Deserialize, Serialize};
use std::collections::BTreeSet;
use std::path::Path;

/// The column that says that a file holds ways.
pub(crate) const WAY: &str = "way";
/// The column beside it; without it all are driven forward.
pub(crate) const DIRECTION: &str = "direction";

/// What tells the way in a row.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct WayColumns {
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
pub(crate) fn check_way(way: &str) -> std::result::Result<(), Flaw> {
    if way.trim().is_empty() || way.chars().any(char::is_control) {
        return Err(Flaw {
            problem: format!("way is {way:?}"),
            expected: "a name of some letters or digits",
        });
    }
    Ok(())
}

/// Rows as they come, to be told apart by way.
pub(crate) struct Grouping<T> {
    ways: Vec<WayRows<T>>,
    seen: BTreeSet<WayName>,
}

impl<T> Grouping<T> {
    pub(crate) const fn new() -> Self {
        Self {
            ways: Vec::new(),
            seen: BTreeSet::new(),
        }
    }

    /// Adds a row behind those of its way; `check` judges it with the one before.
    pub(crate) fn add(
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

    pub(crate) fn done(self) -> Vec<WayRows<T>> {
        self.ways
    }
}

/// Reads the rows of a CSV file, way by way.
///
/// # Errors
/// With file, line and what was expected.
pub(crate) fn read_csv<T: for<'de> Deserialize<'de>>(
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
pub(crate) fn name_of([way, direction]: [Option<&str>; 2]) -> std::result::Result<WayName, Flaw> {
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
pub(crate) fn single<T>(path: &Path, mut ways: Vec<WayRows<T>>) -> Result<Vec<T>> {
    match ways.len() {
        0 => Ok(Vec::new()),
        1 => Ok(ways.swap_remove(0).rows),
        several => {
            let problem = format!("{several} ways; expected a single road here");
            Err(Error::content(path, problem))
        }
    }
}
