//! Files with one road, or with several ways in the columns `way` and `direction`.

use crate::error::{Error, Result};
use crate::files::csv::{Record, read_records};
use crate::files::limits::too_many_rows;
use crate::files::row_check::Flaw;
use crate::map::fusion::map_row::WayRows;
use crate::map::geometry::way_name::{WayDirection, WayName};
use serde::{Deserialize, Serialize};
use std::collections::BTreeSet;
use std::path::Path;

/// Column of the way's name; its presence marks a file of ways.
pub(crate) const WAY: &str = "way";
/// Column of the direction; without it all ways are driven forward.
pub(crate) const DIRECTION: &str = "direction";

/// The columns of a way's name.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct WayColumns {
    way: String,
    #[serde(default)]
    direction: Option<WayDirection>,
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
            direction: self.direction.unwrap_or(WayDirection::Forward),
        })
    }
}

/// Checks the name of a way.
pub(crate) fn check_way(way: &str) -> std::result::Result<(), Flaw> {
    if way.trim().is_empty() || way.chars().any(char::is_control) {
        return Err(Flaw {
            problem: format!("way is {way:?}"),
            expected: "a name of some letters or digits",
        });
    }
    Ok(())
}

/// Groups rows by way.
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

    /// Adds a row to its way; `check` gets it with the row before.
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
                problem: format!("way {name} appears twice"),
                expected: "the rows of a way in one block",
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

/// Reads the rows of a CSV file, way by way; at most `most`.
///
/// # Errors
/// Returns an error that names the file, the line and the expected value.
pub(crate) fn read_csv<T: for<'de> Deserialize<'de>>(
    path: &Path,
    most: usize,
    check: fn(Option<&T>, &T) -> std::result::Result<(), Flaw>,
) -> Result<Vec<WayRows<T>>> {
    let mut grouping = Grouping::new();
    let mut rows = 0;
    read_records(&csv::ReaderBuilder::new(), path, |record: &Record| {
        rows += 1;
        if rows > most {
            return Err(too_many_rows(path, most));
        }
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

/// Returns the name of a way from the columns of a Parquet file.
pub(crate) fn name_of([way, direction]: [Option<&str>; 2]) -> std::result::Result<WayName, Flaw> {
    let direction = match direction {
        None => None,
        Some("forward") => Some(WayDirection::Forward),
        Some("backward") => Some(WayDirection::Backward),
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

/// Returns the rows of a file with a single road.
pub(crate) fn single<T>(path: &Path, mut ways: Vec<WayRows<T>>) -> Result<Vec<T>> {
    match ways.len() {
        0 => Ok(Vec::new()),
        1 => Ok(ways.swap_remove(0).rows),
        several => {
            let problem = format!("{several} ways; expected a single road");
            Err(Error::content(path, problem))
        }
    }
}
